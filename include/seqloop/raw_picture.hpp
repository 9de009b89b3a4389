// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace seqloop {

/// How a camera lays out its pixels.
enum class RawFormat : std::uint8_t {
  gray8,
  bgr8,
  rgb8,
  yuyv,  ///< Y U Y V, 2 bytes a pixel
  uyvy,  ///< U Y V Y, 2 bytes a pixel
  nv12,  ///< Y plane, then U V of every second pixel and row
  yu12,  ///< Y plane, then U plane, then V plane, each of every second pixel and row
  mjpg   ///< one JPEG picture a frame
};

/// A picture as it is delivered, in somebody else's memory.
struct RawPicture {
  std::span<const std::uint8_t> bytes;  ///< all planes, one behind the other
  int width = 0;                        ///< pixels
  int height = 0;                       ///< pixels
  std::size_t stride = 0;  ///< bytes from one row of the first plane to the next; 0 for `mjpg`.
                           ///< The chroma rows of `nv12` are as far apart, those of `yu12` half
  RawFormat format = RawFormat::gray8;
};

/// `GREY`, `BGR3`, `RGB3`, `YUYV`, `UYVY`, `NV12`, `YU12`, `MJPG`: the four characters of V4L2.
[[nodiscard]] std::string_view name(RawFormat format) noexcept;

/// Bytes of the pixels in one row of the first plane, without padding; 0 for `mjpg`.
[[nodiscard]] std::size_t row_bytes(RawFormat format, int width) noexcept;

/// Bytes that a whole picture has at least; 0 for `mjpg`, which has as many as it needs.
[[nodiscard]] std::size_t bytes_of(RawFormat format, std::size_t stride, int height) noexcept;

}  // namespace seqloop
