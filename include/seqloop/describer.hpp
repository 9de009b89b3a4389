// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "seqloop/frame.hpp"
#include "seqloop/picture_needs.hpp"

namespace seqloop {

enum class Description : std::uint8_t {
  good,   ///< a unit vector, or what the matcher's difference wants
  blank,  ///< no feature in the picture: the zero vector (Algorithm 1), or what says the same
  failed  ///< the picture could not be described; `last_fault()` says why
};

/// Port: turns a picture into a descriptor (Algorithm 1).
class Describer {
 public:
  Describer() = default;
  Describer(const Describer&) = delete;
  Describer& operator=(const Describer&) = delete;
  Describer(Describer&&) = delete;
  Describer& operator=(Describer&&) = delete;
  virtual ~Describer() = default;

  /// Values in one descriptor, D.
  [[nodiscard]] virtual std::size_t size() const noexcept = 0;

  /// What it makes of pictures; unless it says otherwise, it looks at all of them, in colour.
  [[nodiscard]] virtual PictureNeeds needs() const noexcept { return {}; }

  /// @param image    any size; grey or BGR
  /// @param descriptor [D], written: unit L2 or zero, or as the describer says that its descriptors
  ///   are compared; left alone when the call fails
  /// Errors: none thrown. Allocates: whatever the library behind it does.
  [[nodiscard]] virtual Description describe(const Image& image,
                                             std::span<float> descriptor) noexcept = 0;

  /// Why the last call failed; valid until the next call.
  [[nodiscard]] virtual std::string_view last_fault() const noexcept = 0;
};

}  // namespace seqloop
