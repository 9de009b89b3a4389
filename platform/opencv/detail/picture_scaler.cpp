// SPDX-License-Identifier: MIT
#include "opencv/detail/picture_scaler.hpp"

#include <opencv2/imgproc.hpp>

#include "opencv/detail/picture_view.hpp"

namespace seqloop::opencv {

cv::Mat PictureScaler::scale(const Image& image) {
  cv::Mat picture = matrix(image);
  if (gray_ && picture.channels() == 3) {
    cv::cvtColor(picture, gray_picture_, cv::COLOR_BGR2GRAY);
    picture = gray_picture_;
  }
  if (!size_.empty() && picture.size() != size_) {
    const bool shrinks = picture.cols >= size_.width && picture.rows >= size_.height;
    if (shrinks && picture.channels() == 1) {
      shrinker_.shrink(picture, size_, resized_);
    } else {
      cv::resize(picture, resized_, size_, 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    }
    picture = resized_;
  }
  return picture;
}

}  // namespace seqloop::opencv
