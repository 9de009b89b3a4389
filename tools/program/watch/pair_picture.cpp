// SPDX-License-Identifier: MIT
#include "program/watch/pair_picture.hpp"

#include <exception>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::program {
namespace {

cv::Mat decode(const std::string& jpeg) {
  const std::vector<std::uint8_t> bytes(jpeg.begin(), jpeg.end());
  return bytes.empty() ? cv::Mat() : opencv::file_codecs().decode(bytes, cv::IMREAD_COLOR);
}

std::vector<std::uint8_t> side_by_side(const std::string& left_jpeg,
                                       const std::string& right_jpeg) {
  const cv::Mat left = decode(left_jpeg);
  const cv::Mat right = decode(right_jpeg);
  if (left.empty() || right.empty()) return {};
  cv::Mat pair(std::max(left.rows, right.rows), left.cols + right.cols, CV_8UC3,
               cv::Scalar::all(0));
  left.copyTo(pair(cv::Rect({0, 0}, left.size())));
  right.copyTo(pair(cv::Rect({left.cols, 0}, right.size())));
  std::vector<std::uint8_t> bytes;
  opencv::file_codecs().encode(".jpg", pair, bytes);
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> pair_picture(const std::string& left_jpeg,
                                       const std::string& right_jpeg) {
  // In a thread of its own, where whatever is thrown would end the run.
  try {
    return side_by_side(left_jpeg, right_jpeg);
  } catch (const std::exception&) {  // OpenCV's readers cannot be loaded, or there is no memory
    return {};
  }
}

}  // namespace seqloop::program
