// SPDX-License-Identifier: MIT
#include "seqloop/opencv/builtin_describer.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "platform/pictures.hpp"

namespace seqloop::opencv {
namespace {

TEST(BuiltinDescriber, MakesUnitDescriptorsOfAnyPicture) {
  const auto describer = make_builtin_describer();
  ASSERT_GT(describer->size(), 0U);
  std::vector<float> first(describer->size());
  for (const auto& size : {cv::Size(640, 480), cv::Size(128, 64), cv::Size(64, 32)}) {
    for (const int type : {CV_8UC1, CV_8UC3}) {
      const cv::Mat picture = test::textured(size.width, size.height, 1, type);
      ASSERT_EQ(describer->describe(test::image_of(picture), first), Description::good);
      EXPECT_NEAR(std::inner_product(first.begin(), first.end(), first.begin(), 0.0), 1.0, 1e-5);
      std::vector<float> again(describer->size());
      ASSERT_EQ(describer->describe(test::image_of(picture), again), Description::good);
      EXPECT_EQ(first, again);
    }
  }
}

TEST(BuiltinDescriber, TellsPicturesApart) {
  const auto describer = make_builtin_describer();
  std::vector<float> one(describer->size());
  std::vector<float> other(describer->size());
  ASSERT_EQ(describer->describe(test::image_of(test::textured(160, 80, 1)), one),
            Description::good);
  ASSERT_EQ(describer->describe(test::image_of(test::textured(160, 80, 2)), other),
            Description::good);
  EXPECT_LT(std::inner_product(one.begin(), one.end(), other.begin(), 0.0), 0.999);
}

TEST(BuiltinDescriber, NeedsGrayPicturesOfItsInputSize) {
  const auto describer = make_builtin_describer();
  const PictureNeeds needs = describer->needs();
  EXPECT_EQ(needs.width, describer->input_width());
  EXPECT_EQ(needs.height, describer->input_height());
  EXPECT_GT(needs.width, 0);
  EXPECT_TRUE(needs.gray_is_enough);
}

}  // namespace
}  // namespace seqloop::opencv
