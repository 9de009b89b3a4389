// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace seqloop {

/// How a camera, or a message of ROS, lays out its pixels.
enum class RawFormat : std::uint8_t {
  gray8,
  bgr8,
  rgb8,
  bgra8,     ///< the fourth byte of a pixel is not looked at
  rgba8,     ///< likewise
  gray16,    ///< the less significant byte first
  gray16be,  ///< the more significant byte first
  yuyv,      ///< Y U Y V, 2 bytes a pixel
  uyvy,      ///< U Y V Y, 2 bytes a pixel
  nv12,      ///< Y plane, then U V of every second pixel and row
  yu12,      ///< Y plane, then U plane, then V plane, each of every second pixel and row
  mjpg,      ///< one JPEG picture a frame
  png        ///< one PNG picture a frame
};

/// A picture as it is delivered, in somebody else's memory.
struct RawPicture {
  std::span<const std::uint8_t> bytes;  ///< all planes, one behind the other
  int width = 0;                        ///< pixels
  int height = 0;                       ///< pixels
  std::size_t stride =
      0;  ///< bytes from one row of the first plane to the next; 0 for `mjpg` and `png`.
          ///< The chroma rows of `nv12` are as far apart, those of `yu12` half
  RawFormat format = RawFormat::gray8;
};

/// `GREY`, `BGR3`, `RGB3`, `YUYV`, `UYVY`, `NV12`, `YU12`, `MJPG`: the four characters of V4L2; and
/// `BGRA`, `RGBA`, `Y16`, `Y16 big-endian`, `PNG`.
[[nodiscard]] std::string_view name(RawFormat format) noexcept;

/// Bytes of the pixels in one row of the first plane, without padding; 0 for `mjpg` and `png`.
[[nodiscard]] std::size_t row_bytes(RawFormat format, int width) noexcept;

/// Bytes that a whole picture has at least; 0 for `mjpg` and `png`, which have as many as
/// they need.
[[nodiscard]] std::size_t bytes_of(RawFormat format, std::size_t stride, int height) noexcept;

}  // namespace seqloop
