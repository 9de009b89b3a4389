// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/describer.hpp"

namespace seqloop::opencv {

/// SeqSLAM's pictures: grey, small, and in patches of 8 x 8 pixels without overlap each patch less
/// its mean and divided by its sample standard deviation (a flat patch: zero), clamped to 4
/// deviations and mapped to 0 .. 255, zero to 127.5. Made to be compared by mean absolute
/// difference: they are not of unit length.
class PatchDescriber : public Describer {
 public:
  static constexpr int patch = 8;  ///< pixels a side

  /// @param width, height pixels, whole numbers of patches
  /// Throws SetupError where they are not.
  explicit PatchDescriber(int width = 64, int height = 32);
  PatchDescriber(const PatchDescriber&) = delete;
  PatchDescriber& operator=(const PatchDescriber&) = delete;
  PatchDescriber(PatchDescriber&&) = delete;
  PatchDescriber& operator=(PatchDescriber&&) = delete;
  ~PatchDescriber() override;

  /// width * height
  [[nodiscard]] std::size_t size() const noexcept override;

  /// Grey pictures, width x height.
  [[nodiscard]] PictureNeeds needs() const noexcept override;

  /// Colour becomes grey, then the picture is brought to its size by averaging (shrinking) or
  /// linearly (enlarging).
  /// @param descriptor [height, width] row by row; all 127.5 for a picture that is `blank`, each
  ///   patch being flat
  /// `failed` for an empty picture and a span that is not [D]. Work: a grey picture, a resized one,
  /// and D. Allocates: what OpenCV does for that.
  [[nodiscard]] Description describe(const Image& image,
                                     std::span<float> descriptor) noexcept override;

  [[nodiscard]] std::string_view last_fault() const noexcept override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
