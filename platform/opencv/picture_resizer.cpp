// SPDX-License-Identifier: MIT
#include "opencv/picture_resizer.hpp"

#include "opencv/detail/picture_scaler.hpp"
#include "opencv/detail/picture_view.hpp"

namespace seqloop::opencv {

class PictureResizer::Impl : public PictureScaler {
 public:
  using PictureScaler::PictureScaler;
};

PictureResizer::PictureResizer(int width, int height, bool gray)
    : impl_(std::make_unique<Impl>(cv::Size(width, height), gray)) {}

PictureResizer::~PictureResizer() = default;

Image PictureResizer::resize(const Image& picture) noexcept {
  try {
    return view(impl_->scale(picture));
  } catch (...) {
    return {};
  }
}

}  // namespace seqloop::opencv
