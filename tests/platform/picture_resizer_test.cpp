// SPDX-License-Identifier: MIT
#include "opencv/picture_resizer.hpp"

#include <gtest/gtest.h>

#include "platform/pictures.hpp"

namespace seqloop::opencv {
namespace {

TEST(PictureResizer, HandsThroughWhatFits) {
  const cv::Mat picture = test::textured(8, 6);
  for (const auto& [width, height] : {std::pair{0, 0}, std::pair{8, 6}}) {
    PictureResizer resizer(width, height, false);
    EXPECT_EQ(resizer.resize(test::image_of(picture)).data, picture.data);
  }
  const cv::Mat gray = test::textured(8, 6, 1, CV_8UC1);
  PictureResizer resizer(0, 0, true);
  EXPECT_EQ(resizer.resize(test::image_of(gray)).data, gray.data);
}

TEST(PictureResizer, ShrinksByAveragingOfPaddedRows) {
  const cv::Mat wide = test::textured(10, 4, 7, CV_8UC1);
  const cv::Mat picture = wide(cv::Rect(3, 0, 6, 4));
  PictureResizer resizer(3, 2, true);
  const Image small = resizer.resize(test::image_of(picture));
  ASSERT_EQ(small.width, 3);
  ASSERT_EQ(small.height, 2);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const double mean = cv::mean(picture(cv::Rect(2 * x, 2 * y, 2, 2)))[0];
      EXPECT_NEAR(
          small.data[static_cast<std::size_t>(y) * small.stride + static_cast<std::size_t>(x)],
          mean, 0.5);
    }
  }
}

TEST(PictureResizer, GrowsAndTakesAnySizeInTurn) {
  PictureResizer resizer(16, 12, true);
  for (const auto& [width, height] : {std::pair{8, 6}, std::pair{1, 1}, std::pair{40, 3}}) {
    const cv::Mat picture(height, width, CV_8UC3, cv::Scalar(0, 100, 0));
    const Image big = resizer.resize(test::image_of(picture));
    EXPECT_EQ(big.width, 16);
    EXPECT_EQ(big.height, 12);
    EXPECT_EQ(big.format, PixelFormat::gray8);
    EXPECT_EQ(big.data[11 * big.stride + 15], 59) << "0.587 * 100";
  }
}

}  // namespace
}  // namespace seqloop::opencv
