// SPDX-License-Identifier: MIT
#include "opencv/detail/area_shrinker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "platform/pictures.hpp"

namespace seqloop::opencv {
namespace {

/// What one new pixel covers of an old one, in parts of which an old pixel has `new_size`.
std::int64_t covered(int new_pixel, int old_pixel, int old_size, int new_size) {
  const std::int64_t begin = std::max(std::int64_t{new_pixel} * old_size,  //
                                      std::int64_t{old_pixel} * new_size);
  const std::int64_t end =
      std::min((new_pixel + std::int64_t{1}) * old_size, (old_pixel + std::int64_t{1}) * new_size);
  return std::max(end - begin, std::int64_t{0});
}

/// The definition: every old pixel, by what of it is covered; halves up.
cv::Mat oracle(const cv::Mat& picture, const cv::Size& size) {
  cv::Mat shrunk(size, CV_8UC1);
  const std::int64_t all = std::int64_t{picture.cols} * picture.rows;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      std::int64_t sum = 0;
      for (int row = 0; row < picture.rows; ++row) {
        for (int column = 0; column < picture.cols; ++column) {
          sum += covered(y, row, picture.rows, size.height) *
                 covered(x, column, picture.cols, size.width) *
                 picture.at<std::uint8_t>(row, column);
        }
      }
      shrunk.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>((2 * sum + all) / (2 * all));
    }
  }
  return shrunk;
}

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(AreaShrinker, AveragesWhatEachPixelCovers) {
  AreaShrinker shrinker;
  cv::Mat shrunk;
  for (const auto& [from, to] : std::array<std::pair<cv::Size, cv::Size>, 8>{
           {{{1, 1}, {1, 1}},
            {{7, 5}, {7, 5}},
            {{7, 5}, {3, 2}},
            {{7, 5}, {7, 1}},
            {{64, 36}, {16, 9}},
            {{40, 30}, {16, 4}},
            {{3, 600}, {2, 1}},  // more rows than 16 bits hold sums of
            {{33, 17}, {32, 16}}}}) {
    const cv::Mat picture = test::textured(from.width, from.height, 3, CV_8UC1);
    shrinker.shrink(picture, to, shrunk);
    EXPECT_TRUE(same(shrunk, oracle(picture, to))) << from << " to " << to;
    const cv::Mat white(from, CV_8UC1, cv::Scalar(255));
    shrinker.shrink(white, to, shrunk);
    EXPECT_TRUE(same(shrunk, cv::Mat(to, CV_8UC1, cv::Scalar(255)))) << from << " to " << to;
  }
}

TEST(AreaShrinker, AgreesWithOpenCvButForItsRounding) {
  AreaShrinker shrinker;
  cv::Mat shrunk;
  cv::Mat expected;
  const cv::Size to(128, 64);
  for (const cv::Size& from :
       {cv::Size(640, 480), cv::Size(960, 540), cv::Size(320, 180), cv::Size(129, 65)}) {
    const cv::Mat wide = test::textured(from.width + 3, from.height, 4, CV_8UC1);
    const cv::Mat picture = wide(cv::Rect(cv::Point(2, 0), from));
    shrinker.shrink(picture, to, shrunk);
    cv::resize(picture, expected, to, 0.0, 0.0, cv::INTER_AREA);
    EXPECT_LE(cv::norm(shrunk, expected, cv::NORM_INF), 1.0) << from;
    EXPECT_LE(cv::countNonZero(shrunk != expected), 8) << from;
  }
}

}  // namespace
}  // namespace seqloop::opencv
