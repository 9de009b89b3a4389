// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "opencv/detail/picture_scaler.hpp"
#include "seqloop/frame.hpp"

namespace seqloop::opencv {

/// Turns pictures into a net's input, reusing its memory from picture to picture.
class PictureBlob {
 public:
  struct Layout {
    int width = 0;                ///< pixels
    int height = 0;               ///< pixels
    int channels = 0;             ///< 1 or 3
    std::array<float, 3> mean{};  ///< B, G, R of the picture; the first alone for one channel
    float scale = 1.0F;
    bool swap_rb = false;  ///< planes R, G, B instead of B, G, R
  };

  explicit PictureBlob(const Layout& layout);

  /// Grey where one channel is wanted, the input's size (see PictureScaler), (pixel - mean) *
  /// scale, one plane a channel. May throw cv::Exception.
  void fill(const Image& image);

  [[nodiscard]] const cv::Mat& mat() const noexcept { return blob_; }  ///< [1, channels, h, w]

 private:
  Layout layout_;
  PictureScaler scaler_;
  cv::Mat blob_;
};

}  // namespace seqloop::opencv
