// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace seqloop::turbojpeg {

/// What a JPEG picture says of itself before its data begin.
struct JpegHeader {
  int width = 0;       ///< pixels
  int height = 0;      ///< pixels
  int components = 0;  ///< 1 or 3
};

/// Walks the segments up to the picture's data. What cameras never send and what would cost more
/// memory or time than the picture's size says is refused: progressive and arithmetic coding, 12
/// bits, four colours, a scan that does not hold all components.
/// @param header written where nothing is wrong
/// @return why the picture cannot be decoded; empty when nothing was found. Allocates: never
[[nodiscard]] std::string_view read_jpeg_header(std::span<const std::uint8_t> bytes,
                                                JpegHeader& header) noexcept;

}  // namespace seqloop::turbojpeg
