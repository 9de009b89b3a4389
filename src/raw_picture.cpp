// SPDX-License-Identifier: MIT
#include "seqloop/raw_picture.hpp"

#include <algorithm>

namespace seqloop {

std::string_view name(RawFormat format) noexcept {
  switch (format) {
    case RawFormat::gray8:
      return "GREY";
    case RawFormat::bgr8:
      return "BGR3";
    case RawFormat::rgb8:
      return "RGB3";
    case RawFormat::bgra8:
      return "BGRA";
    case RawFormat::rgba8:
      return "RGBA";
    case RawFormat::gray16:
      return "Y16";
    case RawFormat::gray16be:
      return "Y16 big-endian";
    case RawFormat::yuyv:
      return "YUYV";
    case RawFormat::uyvy:
      return "UYVY";
    case RawFormat::nv12:
      return "NV12";
    case RawFormat::yu12:
      return "YU12";
    case RawFormat::mjpg:
      return "MJPG";
    case RawFormat::png:
      return "PNG";
  }
  return "?";
}

std::size_t row_bytes(RawFormat format, int width) noexcept {
  const auto pixels = static_cast<std::size_t>(std::max(width, 0));
  switch (format) {
    case RawFormat::gray8:
    case RawFormat::nv12:
    case RawFormat::yu12:
      return pixels;
    case RawFormat::yuyv:
    case RawFormat::uyvy:
    case RawFormat::gray16:
    case RawFormat::gray16be:
      return pixels * 2;
    case RawFormat::bgr8:
    case RawFormat::rgb8:
      return pixels * 3;
    case RawFormat::bgra8:
    case RawFormat::rgba8:
      return pixels * 4;
    case RawFormat::mjpg:
    case RawFormat::png:
      break;
  }
  return 0;
}

std::size_t bytes_of(RawFormat format, std::size_t stride, int height) noexcept {
  const auto rows = static_cast<std::size_t>(height > 0 ? height : 0);
  switch (format) {
    case RawFormat::nv12:
      return stride * (rows + (rows + 1) / 2);
    case RawFormat::yu12:
      return stride * rows + 2 * (stride / 2) * ((rows + 1) / 2);
    case RawFormat::mjpg:
    case RawFormat::png:
      return 0;
    default:
      return stride * rows;
  }
}

}  // namespace seqloop
