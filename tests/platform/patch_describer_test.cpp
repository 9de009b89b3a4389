// SPDX-License-Identifier: MIT
#include "seqloop/opencv/patch_describer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "expect_setup_error.hpp"
#include "platform/pictures.hpp"

namespace seqloop::opencv {
namespace {

using test::image_of;
using test::textured;

std::vector<float> describe(PatchDescriber& describer, const cv::Mat& picture,
                            Description wanted = Description::good) {
  std::vector<float> descriptor(describer.size());
  EXPECT_EQ(describer.describe(image_of(picture), descriptor), wanted) << describer.last_fault();
  return descriptor;
}

/// By the definition, pixel by pixel, each with its own patch's mean and deviation.
std::vector<float> naively(const cv::Mat& gray) {
  std::vector<float> values;
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      const cv::Mat patch = gray(cv::Rect(x / 8 * 8, y / 8 * 8, 8, 8));
      double mean = 0.0;
      for (int i = 0; i < 64; ++i) mean += patch.at<std::uint8_t>(i / 8, i % 8) / 64.0;
      double squares = 0.0;
      for (int i = 0; i < 64; ++i)
        squares += std::pow(patch.at<std::uint8_t>(i / 8, i % 8) - mean, 2);
      const double deviation = std::sqrt(squares / 63.0);
      const double z = deviation < 1e-9 ? 0.0 : (gray.at<std::uint8_t>(y, x) - mean) / deviation;
      values.push_back(static_cast<float>((std::clamp(z, -4.0, 4.0) + 4.0) * 255.0 / 8.0));
    }
  }
  return values;
}

void expect_near(const std::vector<float>& got, const std::vector<float>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(got[i], wanted[i], 1e-4) << i;
}

TEST(PatchDescriber, NormalisesEachPatchByItself) {
  PatchDescriber describer;
  EXPECT_EQ(describer.size(), 64U * 32U);
  const cv::Mat picture = textured(64, 32, 1, CV_8UC1);
  expect_near(describe(describer, picture), naively(picture));
  PatchDescriber square(24, 40);
  const cv::Mat other = textured(24, 40, 2, CV_8UC1);
  expect_near(describe(square, other), naively(other));
}

// Half 10, half 20: deviation 5 * sqrt(64 / 63), so z = +-sqrt(63) / 8 = +-0.99216.
TEST(PatchDescriber, GivesTheNumbersThatAHandCalculates) {
  PatchDescriber describer(16, 8);
  cv::Mat picture(8, 16, CV_8UC1, cv::Scalar(10));
  picture(cv::Rect(4, 0, 4, 8)).setTo(20);
  picture.at<std::uint8_t>(3, 12) = 255;  // one pixel in a flat patch: z = 7.875, clamped to 4
  const auto values = describe(describer, picture);
  EXPECT_NEAR(values[0], (4.0 - 0.9921567) * 31.875, 1e-4);
  EXPECT_NEAR(values[4], (4.0 + 0.9921567) * 31.875, 1e-4);
  EXPECT_EQ(values[3 * 16 + 12], 255.0F);
  EXPECT_NEAR(values[8], (4.0 - 0.125) * 31.875, 1e-4);  // the others are an eighth below
}

TEST(PatchDescriber, AFlatPatchIsHalfAndAFlatPictureBlank) {
  PatchDescriber describer(16, 8);
  cv::Mat picture(8, 16, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(describe(describer, picture, Description::blank), std::vector<float>(128, 127.5F));
  picture.at<std::uint8_t>(0, 0) = 78;
  const auto values = describe(describer, picture);
  EXPECT_EQ(values[0], 255.0F);
  EXPECT_EQ(values[8], 127.5F);
}

TEST(PatchDescriber, BringsAnyPictureToItsSizeInGrey) {
  PatchDescriber describer;
  for (const auto& size : {cv::Size(200, 117), cv::Size(40, 20)}) {
    const cv::Mat colour = textured(size.width, size.height);
    cv::Mat gray;
    cv::Mat small;
    cv::cvtColor(colour, gray, cv::COLOR_BGR2GRAY);
    cv::resize(gray, small, cv::Size(64, 32), 0.0, 0.0,
               size.width > 64 ? cv::INTER_AREA : cv::INTER_LINEAR);
    const auto values = describe(describer, colour);
    expect_near(values, naively(small));
    EXPECT_EQ(describe(describer, gray), values);
    cv::Mat padded;
    cv::copyMakeBorder(colour, padded, 2, 2, 3, 3, cv::BORDER_CONSTANT);
    EXPECT_EQ(describe(describer, padded(cv::Rect(3, 2, size.width, size.height))), values);
  }
}

// Bad input: sizes that are no patches, pictures that are none.
TEST(PatchDescriber, RefusesWhatItCannotDescribe) {
  for (const cv::Size size : {cv::Size(0, 8), cv::Size(8, 0), cv::Size(-8, 8), cv::Size(60, 32),
                              cv::Size(64, 30), cv::Size(8200, 8)}) {
    const std::string fault = test::setup_error([&] { PatchDescriber(size.width, size.height); });
    const std::string name = std::to_string(size.width) + "x" + std::to_string(size.height);
    EXPECT_TRUE(test::says(fault, name));
    EXPECT_TRUE(test::says(fault, "multiples of 8"));
  }
  PatchDescriber describer;
  std::vector<float> descriptor(describer.size(), 5.0F);
  EXPECT_EQ(describer.describe({}, descriptor), Description::failed);
  EXPECT_EQ(describer.last_fault(), "the picture is empty");
  const cv::Mat picture = textured(64, 32);
  EXPECT_EQ(describer.describe(image_of(picture), std::span(descriptor).first(7)),
            Description::failed);
  Image narrow = image_of(picture);
  narrow.stride = 64;
  EXPECT_EQ(describer.describe(narrow, descriptor), Description::failed);
  EXPECT_EQ(descriptor, std::vector<float>(describer.size(), 5.0F));
  static_cast<void>(describe(describer, picture));
  EXPECT_EQ(describer.last_fault(), "");
}

TEST(PatchDescriber, NeedsSmallGrayPictures) {
  const PictureNeeds needs = PatchDescriber(48, 24).needs();
  EXPECT_EQ(needs.width, 48);
  EXPECT_EQ(needs.height, 24);
  EXPECT_TRUE(needs.gray_is_enough);
}

}  // namespace
}  // namespace seqloop::opencv
