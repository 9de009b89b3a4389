// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "platform/pictures.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop::test {

/// A drive of pictures in memory; an empty one cannot be read.
class SyntheticDrive : public FrameSource {
 public:
  explicit SyntheticDrive(std::vector<cv::Mat> pictures, double frames_per_second = 10.0)
      : pictures_(std::move(pictures)), frames_per_second_(frames_per_second) {}

  Grab grab(Frame& frame) noexcept override {
    frame = Frame{};
    frame.index = next_;
    frame.time_s = static_cast<double>(next_) / frames_per_second_;
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

  [[nodiscard]] std::vector<std::string> notes() const override { return {"made"}; }

 private:
  std::vector<cv::Mat> pictures_;
  double frames_per_second_;
  std::size_t next_ = 0;
};

}  // namespace seqloop::test
