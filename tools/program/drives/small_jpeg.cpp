// SPDX-License-Identifier: MIT
// By itself: who only takes pictures along needs no OpenCV.
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "program/drives/small_picture.hpp"

namespace seqloop::program {

std::string jpeg(const SmallPictureFacts& facts, std::span<const std::uint8_t> pixels,
                 int quality) {
  // cv::Mat has no view of constant pixels; this one is only read.
  const cv::Mat view(facts.height, facts.width, facts.gray ? CV_8UC1 : CV_8UC3,
                     const_cast<std::uint8_t*>(pixels.data()));
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", view, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {bytes.begin(), bytes.end()};
}

}  // namespace seqloop::program
