// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "seqloop/frame.hpp"

namespace seqloop::program {

/// A picture for people, and what it is of.
struct SmallPictureFacts {
  std::uint64_t number = 0;  ///< of the frame or the place
  int width = 0;             ///< pixels
  int height = 0;            ///< pixels
  bool gray = true;          ///< a byte a pixel; otherwise B, G, R

  /// Bytes of its pixels.
  [[nodiscard]] std::size_t bytes() const noexcept {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * (gray ? 1U : 3U);
  }
};

/// A picture in fixed memory: at most this large, every n-th pixel of the loop's own.
template <int width_limit, int height_limit>
struct PictureWithin : SmallPictureFacts {
  static constexpr int most_width = width_limit;    // pixels
  static constexpr int most_height = height_limit;  // pixels

  /// Row by row; the rest means nothing.
  std::array<std::uint8_t, std::size_t{3} * width_limit * height_limit> pixels{};
};

/// Takes every n-th pixel of a picture, so that it fits.
/// @param pixels [3 * most_width * most_height] written as far as the picture goes
/// @return false where there is no picture. Work: its pixels. Allocates: never.
bool shrink(const Image& image, std::uint64_t number, int most_width, int most_height,
            SmallPictureFacts& facts, std::span<std::uint8_t> pixels) noexcept;

template <int width, int height>
bool shrink(const Image& image, std::uint64_t number,
            PictureWithin<width, height>& small) noexcept {
  return shrink(image, number, width, height, small, small.pixels);
}

/// Makes a JPEG file. @param pixels [facts.bytes()]   @param quality 1 .. 100. Allocates: yes.
using JpegEncoder = std::string (*)(const SmallPictureFacts& facts,
                                    std::span<const std::uint8_t> pixels, int quality);

/// The one of libjpeg-turbo.
[[nodiscard]] std::string jpeg(const SmallPictureFacts& facts, std::span<const std::uint8_t> pixels,
                               int quality);

}  // namespace seqloop::program
