#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "platform/pictures.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop::test {

/// A drive of pictures at hand; an empty one is a frame that cannot be read.
class PictureList : public FrameSource {
 public:
  explicit PictureList(std::vector<cv::Mat> pictures) : pictures_(std::move(pictures)) {}

  [[nodiscard]] Grab grab(Frame& frame) noexcept override {
    frame = {};
    frame.index = next_;
    if (next_ == pictures_.size()) return Grab::end;
    const cv::Mat& picture = pictures_[next_++];
    if (picture.empty()) {
      frame.fault = "torn";
      return Grab::unreadable;
    }
    frame.image = image_of(picture);
    return Grab::frame;
  }
  [[nodiscard]] std::optional<std::uint64_t> frame_count() const noexcept override {
    return pictures_.size();
  }

 private:
  std::vector<cv::Mat> pictures_;
  std::size_t next_ = 0;
};

}  // namespace seqloop::test
