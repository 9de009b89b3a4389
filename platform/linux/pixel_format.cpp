// SPDX-License-Identifier: MIT
#include "seqloop/linux/pixel_format.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace seqloop::live {
namespace {

struct Known {
  std::uint32_t fourcc;
  RawFormat format;
};
constexpr std::array known{
    Known{V4L2_PIX_FMT_GREY, RawFormat::gray8},  Known{V4L2_PIX_FMT_BGR24, RawFormat::bgr8},
    Known{V4L2_PIX_FMT_RGB24, RawFormat::rgb8},  Known{V4L2_PIX_FMT_YUYV, RawFormat::yuyv},
    Known{V4L2_PIX_FMT_UYVY, RawFormat::uyvy},   Known{V4L2_PIX_FMT_NV12, RawFormat::nv12},
    Known{V4L2_PIX_FMT_YUV420, RawFormat::yu12}, Known{V4L2_PIX_FMT_MJPEG, RawFormat::mjpg},
    Known{V4L2_PIX_FMT_JPEG, RawFormat::mjpg}};
constexpr std::uint32_t big_endian = 1U << 31;

}  // namespace

std::optional<RawFormat> readable(std::uint32_t fourcc) noexcept {
  for (const Known& entry : known) {
    if (entry.fourcc == fourcc) return entry.format;
  }
  return std::nullopt;
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<unsigned char>(((fourcc & ~big_endian) >> shift) & 0xFFU);
    text += std::isprint(letter) != 0 ? static_cast<char>(letter) : '?';
  }
  while (text.size() > 1 && text.back() == ' ') text.pop_back();
  return (fourcc & big_endian) != 0 ? text + "-BE" : text;
}

std::optional<RawFormat> format_named(std::string_view wanted) noexcept {
  const auto same = [](char left, char right) {
    return std::toupper(static_cast<unsigned char>(left)) == right;
  };
  for (const Known& entry : known) {
    if (std::ranges::equal(wanted, name(entry.format), same)) return entry.format;
  }
  return std::nullopt;
}

std::size_t least_bytes(RawFormat format, std::size_t stride, int width, int height) noexcept {
  if (format == RawFormat::mjpg) return 1;
  const std::size_t padding = stride - std::min(stride, row_bytes(format, width));
  // The last row of `yu12` is one of half the width.
  return bytes_of(format, stride, height) - (format == RawFormat::yu12 ? padding / 2 : padding);
}

}  // namespace seqloop::live
