// SPDX-License-Identifier: MIT
#include "opencv/detail/picture_blob.hpp"

namespace seqloop::opencv {

PictureBlob::PictureBlob(const Layout& layout)
    : layout_(layout), scaler_(cv::Size(layout.width, layout.height), layout.channels == 1) {
  const std::array<int, 4> shape{1, layout.channels, layout.height, layout.width};
  blob_.create(static_cast<int>(shape.size()), shape.data(), CV_32F);
}

void PictureBlob::fill(const Image& image) {
  const cv::Mat picture = scaler_.scale(image);
  const int step = picture.channels();
  for (int plane = 0; plane < layout_.channels; ++plane) {
    const int channel = layout_.swap_rb && layout_.channels == 3 ? 2 - plane : plane;
    const float mean = layout_.mean[static_cast<std::size_t>(channel)];
    for (int y = 0; y < layout_.height; ++y) {
      const std::uint8_t* from = picture.ptr<std::uint8_t>(y) + (step == 1 ? 0 : channel);
      float* to = blob_.ptr<float>(0, plane) + static_cast<std::ptrdiff_t>(y) * layout_.width;
      for (int x = 0; x < layout_.width; ++x)
        to[x] = (static_cast<float>(from[x * step]) - mean) * layout_.scale;
    }
  }
}

}  // namespace seqloop::opencv
