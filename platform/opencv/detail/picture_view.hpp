#pragma once

#include <opencv2/core.hpp>

#include "seqloop/frame.hpp"

namespace seqloop::opencv {

/// @param picture CV_8UC1 or CV_8UC3 (B, G, R); must outlive the view
[[nodiscard]] inline Image view(const cv::Mat& picture) noexcept {
  return {picture.data, picture.cols, picture.rows, picture.step[0],
          picture.channels() == 1 ? PixelFormat::gray8 : PixelFormat::bgr8};
}

}  // namespace seqloop::opencv
