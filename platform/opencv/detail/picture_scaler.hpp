// SPDX-License-Identifier: MIT
#pragma once

#include <opencv2/core.hpp>

#include "opencv/detail/area_shrinker.hpp"
#include "seqloop/frame.hpp"

namespace seqloop::opencv {

/// Brings pictures to one size, reusing its memory from picture to picture.
class PictureScaler {
 public:
  /// @param size empty: every picture keeps its own   @param gray colour becomes grey
  PictureScaler(const cv::Size& size, bool gray) : size_(size), gray_(gray) {}

  /// Shrinks by averaging (INTER_AREA) and enlarges linearly. Colour becomes grey before the size
  /// changes: that is faster than after and moves no pixel by more than 1. May throw cv::Exception.
  /// @return CV_8UC1 or CV_8UC3, for reading; valid until the next call and as long as the image
  [[nodiscard]] cv::Mat scale(const Image& image);

 private:
  cv::Size size_;
  bool gray_;
  cv::Mat gray_picture_;
  cv::Mat resized_;
  AreaShrinker shrinker_;
};

}  // namespace seqloop::opencv
