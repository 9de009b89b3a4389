// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace seqloop::program {

/// The kept picture nearest to a frame or place, as a JPEG file; empty where none is kept.
/// @param pictures a `PictureStore`, or `PlacePictures`, which may throw SetupError
template <class Pictures>
[[nodiscard]] std::string nearest_jpeg(const Pictures& pictures, std::uint64_t number) {
  const std::vector<std::uint64_t> around = pictures.around(number);
  if (around.empty()) return {};
  const auto distance = [number](std::uint64_t other) {
    return other > number ? other - number : number - other;
  };
  return pictures.jpeg(*std::ranges::min_element(around, {}, distance));
}

/// Two pictures side by side. Allocates: yes.
/// @return a JPEG file; empty where one of them is none
[[nodiscard]] std::vector<std::uint8_t> pair_picture(const std::string& left_jpeg,
                                                     const std::string& right_jpeg);

}  // namespace seqloop::program
