// SPDX-License-Identifier: MIT
// By itself: a program that defines `file_codecs` does not take this file from the library, nor
// what it needs of OpenCV.
#include "seqloop/opencv/file_codecs.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace seqloop::opencv {
namespace {

cv::Mat decode(std::span<const std::uint8_t> file, int flags) {
  // OpenCV has no view of constant bytes; these are only read.
  return cv::imdecode(
      cv::Mat(1, static_cast<int>(file.size()), CV_8UC1, const_cast<std::uint8_t*>(file.data())),
      flags);
}

bool encode(const std::string& ending, const cv::Mat& picture, std::vector<std::uint8_t>& file) {
  return cv::imencode(ending, picture, file);
}

std::unique_ptr<cv::VideoCapture> video() { return std::make_unique<cv::VideoCapture>(); }

}  // namespace

const FileCodecs& file_codecs() {
  static constexpr FileCodecs codecs{decode, encode, video};
  return codecs;
}

}  // namespace seqloop::opencv
