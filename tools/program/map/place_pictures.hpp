// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace seqloop::program {

/// Pictures of places that were seen before this run. Asked by any thread but the loop's, several
/// at once: it may wait for the disk.
class PlacePictures {
 public:
  PlacePictures() = default;
  PlacePictures(const PlacePictures&) = delete;
  PlacePictures& operator=(const PlacePictures&) = delete;
  PlacePictures(PlacePictures&&) = delete;
  PlacePictures& operator=(PlacePictures&&) = delete;
  virtual ~PlacePictures() = default;

  /// Places that have one: the nearest, with the one before and the one after it; fewer at the
  /// ends. Throws SetupError.
  [[nodiscard]] virtual std::vector<std::uint64_t> around(std::uint64_t place) const = 0;

  /// As a JPEG file; empty where this place has none. Throws SetupError.
  [[nodiscard]] virtual std::string jpeg(std::uint64_t place) const = 0;
};

}  // namespace seqloop::program
