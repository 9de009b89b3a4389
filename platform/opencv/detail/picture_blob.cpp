#include "opencv/detail/picture_blob.hpp"

#include <opencv2/imgproc.hpp>

namespace seqloop::opencv {

PictureBlob::PictureBlob(const Layout& layout) : layout_(layout) {
  const std::array<int, 4> shape{1, layout.channels, layout.height, layout.width};
  blob_.create(static_cast<int>(shape.size()), shape.data(), CV_32F);
}

void PictureBlob::fill(const Image& image) {
  const int type = image.format == PixelFormat::gray8 ? CV_8UC1 : CV_8UC3;
  // OpenCV has no Mat over constant data; this one is only read.
  cv::Mat picture(image.height, image.width, type, const_cast<std::uint8_t*>(image.data),
                  image.stride);
  if (layout_.channels == 1 && type == CV_8UC3) {
    cv::cvtColor(picture, gray_, cv::COLOR_BGR2GRAY);
    picture = gray_;
  }
  const cv::Size size(layout_.width, layout_.height);
  if (picture.size() != size) {
    const bool shrinks = picture.cols >= size.width && picture.rows >= size.height;
    cv::resize(picture, resized_, size, 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    picture = resized_;
  }
  const int step = picture.channels();
  for (int plane = 0; plane < layout_.channels; ++plane) {
    const int channel = layout_.swap_rb && layout_.channels == 3 ? 2 - plane : plane;
    const float mean = layout_.mean[static_cast<std::size_t>(channel)];
    for (int y = 0; y < size.height; ++y) {
      const std::uint8_t* from = picture.ptr<std::uint8_t>(y) + (step == 1 ? 0 : channel);
      float* to = blob_.ptr<float>(0, plane) + static_cast<std::ptrdiff_t>(y) * size.width;
      for (int x = 0; x < size.width; ++x)
        to[x] = (static_cast<float>(from[x * step]) - mean) * layout_.scale;
    }
  }
}

}  // namespace seqloop::opencv
