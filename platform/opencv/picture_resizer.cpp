#include "opencv/picture_resizer.hpp"

#include <opencv2/imgproc.hpp>

#include "opencv/detail/picture_view.hpp"

namespace seqloop::opencv {

class PictureResizer::Impl {
 public:
  Impl(int width, int height, bool gray) : size_(width, height), gray_(gray) {}

  [[nodiscard]] Image resize(const Image& image) {
    const int type = image.format == PixelFormat::gray8 ? CV_8UC1 : CV_8UC3;
    // OpenCV has no Mat over constant data; this one is only read.
    cv::Mat picture(image.height, image.width, type, const_cast<std::uint8_t*>(image.data),
                    image.stride);
    if (gray_ && type == CV_8UC3) {
      cv::cvtColor(picture, gray_picture_, cv::COLOR_BGR2GRAY);
      picture = gray_picture_;
    }
    if (!size_.empty() && picture.size() != size_) {
      const bool shrinks = picture.cols >= size_.width && picture.rows >= size_.height;
      cv::resize(picture, resized_, size_, 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
      picture = resized_;
    }
    return view(picture);
  }

 private:
  cv::Size size_;
  bool gray_;
  cv::Mat gray_picture_;
  cv::Mat resized_;
};

PictureResizer::PictureResizer(int width, int height, bool gray)
    : impl_(std::make_unique<Impl>(width, height, gray)) {}

PictureResizer::~PictureResizer() = default;

Image PictureResizer::resize(const Image& picture) noexcept {
  try {
    return impl_->resize(picture);
  } catch (...) {
    return {};
  }
}

}  // namespace seqloop::opencv
