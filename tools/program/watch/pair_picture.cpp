// SPDX-License-Identifier: MIT
#include "program/watch/pair_picture.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::program {
namespace {

cv::Mat nearest(const PictureStore& store, std::uint64_t number) {
  const std::vector<std::uint64_t> around = store.around(number);
  if (around.empty()) return {};
  const auto distance = [number](std::uint64_t other) {
    return other > number ? other - number : number - other;
  };
  const std::string jpeg = store.jpeg(*std::ranges::min_element(around, {}, distance));
  const std::vector<std::uint8_t> bytes(jpeg.begin(), jpeg.end());
  return bytes.empty() ? cv::Mat() : opencv::file_codecs().decode(bytes, cv::IMREAD_COLOR);
}

}  // namespace

std::vector<std::uint8_t> pair_picture(const PictureStore& frames, std::uint64_t frame,
                                       const PictureStore& places, std::uint64_t place) {
  const cv::Mat left = nearest(frames, frame);
  const cv::Mat right = nearest(places, place);
  if (left.empty() || right.empty()) return {};
  cv::Mat pair(std::max(left.rows, right.rows), left.cols + right.cols, CV_8UC3,
               cv::Scalar::all(0));
  left.copyTo(pair(cv::Rect({0, 0}, left.size())));
  right.copyTo(pair(cv::Rect({left.cols, 0}, right.size())));
  std::vector<std::uint8_t> bytes;
  opencv::file_codecs().encode(".jpg", pair, bytes);
  return bytes;
}

}  // namespace seqloop::program
