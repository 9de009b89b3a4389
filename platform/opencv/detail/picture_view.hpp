// SPDX-License-Identifier: MIT
#pragma once

#include <opencv2/core.hpp>
#include <string_view>

#include "seqloop/detail/format_fault.hpp"
#include "seqloop/frame.hpp"

namespace seqloop::opencv {

/// @param picture CV_8UC1 or CV_8UC3 (B, G, R); must outlive the view
[[nodiscard]] inline Image view(const cv::Mat& picture) noexcept {
  return {picture.data, picture.cols, picture.rows, picture.step[0],
          picture.channels() == 1 ? PixelFormat::gray8 : PixelFormat::bgr8};
}

/// @param image without a fault
/// @return the same memory, for reading: OpenCV has no Mat over constant data
[[nodiscard]] inline cv::Mat matrix(const Image& image) {
  const int type = image.format == PixelFormat::gray8 ? CV_8UC1 : CV_8UC3;
  return {image.height, image.width, type, const_cast<std::uint8_t*>(image.data), image.stride};
}

/// What is wrong with a picture; empty where nothing is.
[[nodiscard]] inline std::string_view fault_of(const Image& image) noexcept {
  if (image.data == nullptr || image.width <= 0 || image.height <= 0) return "the picture is empty";
  if (const std::string_view fault = format_fault(image.format); !fault.empty()) return fault;
  const std::size_t bytes_a_pixel = image.format == PixelFormat::gray8 ? 1 : 3;
  if (image.stride < static_cast<std::size_t>(image.width) * bytes_a_pixel)
    return "the picture's rows are shorter than the picture is wide";
  return {};
}

}  // namespace seqloop::opencv
