// SPDX-License-Identifier: MIT
#include "seqloop/opencv/builtin_describer.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <bit>
#include <cmath>
#include <numeric>
#include <random>

#include "platform/pictures.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"

namespace seqloop::opencv {
namespace {

TEST(BuiltinDescriber, MakesUnitDescriptorsOfAnyPicture) {
  const auto describer = make_builtin_describer();
  ASSERT_GT(describer->size(), 0U);
  std::vector<float> first(describer->size());
  for (const auto& size : {cv::Size(640, 480), cv::Size(256, 128), cv::Size(64, 32)}) {
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
  EXPECT_EQ(needs.width, 256);
  EXPECT_EQ(needs.height, 128);
  EXPECT_TRUE(needs.gray_is_enough);
}

TEST(BuiltinDescriber, IsTheNetThatItsScriptMakes) {
  const auto describer = make_builtin_describer();
  const auto net = make_builtin_net();
  ASSERT_EQ(describer->size(), net->size());
  std::vector<float> values(describer->size());
  std::vector<float> expected(describer->size());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    cv::Mat picture = test::textured(256, 128, seed, CV_8UC1);
    if (seed % 2 == 0) picture(cv::Rect(40, 20, 140, 60)) = 100;  // flat cells
    if (seed % 3 == 0) picture = picture > 128;                   // the strongest edges
    ASSERT_EQ(describer->describe(test::image_of(picture), values), Description::good);
    ASSERT_EQ(net->describe(test::image_of(picture), expected), Description::good);
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_NEAR(values[i], expected[i], 1e-6) << i;
  }
  const cv::Mat flat(128, 256, CV_8UC1, cv::Scalar(200));
  EXPECT_EQ(describer->describe(test::image_of(flat), values), Description::blank);
  EXPECT_EQ(net->describe(test::image_of(flat), expected), Description::blank);
  EXPECT_EQ(values, expected);
}

// The sum was made on x86-64. Emulators run this test for ARM.
TEST(BuiltinDescriber, MakesTheSameBytesOnEveryProcessor) {
  std::vector<std::uint8_t> pixels;
  std::mt19937 random(19);
  for (int i = 0; i < 300 * 200; ++i) pixels.push_back(static_cast<std::uint8_t>(random() >> 24U));
  const auto describer = make_builtin_describer();
  std::vector<float> values(describer->size());
  ASSERT_EQ(describer->describe({pixels.data(), 300, 200, 300, PixelFormat::gray8}, values),
            Description::good);
  std::uint64_t sum = 14695981039346656037U;  // FNV-1a
  for (const float value : values) {
    sum = (sum ^ std::bit_cast<std::uint32_t>(value)) * 1099511628211U;
  }
  EXPECT_EQ(sum, 9429671946110791385U);
}

constexpr std::size_t values = 735;

/// The value of a picture's mirror image that means what value `d` does of the picture.
std::size_t mirrored(std::size_t d) {
  constexpr std::size_t orientations = 15;
  constexpr std::size_t cells = 7;
  const std::size_t orientation = d / (cells * cells);
  const std::size_t column = d % cells;
  return ((orientations - orientation) % orientations) * cells * cells + d % (cells * cells) -
         column + (cells - 1 - column);
}

// Its filters stand on every second pixel, and on the others in the mirror: hence the tolerance.
TEST(BuiltinDescriber, SeesInAMirrorWhatItSees) {
  const auto describer = make_builtin_describer();
  cv::Mat picture = test::textured(256, 128, 3, CV_8UC1);
  cv::GaussianBlur(picture, picture, {}, 4.0);
  cv::Mat mirror;
  cv::flip(picture, mirror, 1);
  std::vector<float> one(values);
  std::vector<float> other(values);
  ASSERT_EQ(describer->describe(test::image_of(picture), one), Description::good);
  ASSERT_EQ(describer->describe(test::image_of(mirror), other), Description::good);
  double apart = 0.0;
  double apart_as_they_come = 0.0;
  for (std::size_t d = 0; d < values; ++d) {
    apart += static_cast<double>(std::abs(one[d] - other[mirrored(d)]));
    apart_as_they_come += static_cast<double>(std::abs(one[d] - other[d]));
  }
  EXPECT_LT(apart, 0.2 * apart_as_they_come);
}

TEST(ExpectBuiltin, TellsAnEmptyMapWhatValuesUsuallyAre) {
  const MatcherConfig config{.use = Use::close_loops};
  PlaceMap map(config, {10, values});
  ASSERT_TRUE(expect_builtin(map));
  EXPECT_EQ(map.columns(), 7U);
  const RunningStatistics& usual = map.statistics();
  double squares = 0.0;
  for (std::size_t d = 0; d < values; ++d) {
    ASSERT_GT(usual.mean()[d], 0.005) << d;
    ASSERT_EQ(usual.mean()[d], usual.mean()[mirrored(d)]) << d;
    squares += usual.mean()[d] * usual.mean()[d] + usual.variance()[d];
  }
  EXPECT_NEAR(squares, 1.0, 0.1) << "descriptors are of unit length";
}

TEST(ExpectBuiltin, LetsADriveStartFromThat) {
  const MatcherConfig config{.use = Use::close_loops};
  PlaceMap map(config, {10, values});
  ASSERT_TRUE(expect_builtin(map));
  const Detector detector(config, map);
  EXPECT_EQ(detector.statistics().frames(), config.standardisation.prior_frames);
  EXPECT_EQ(detector.statistics().mean()[100], map.statistics().mean()[100]);
}

TEST(ExpectBuiltin, LeavesOtherMapsAlone) {
  const MatcherConfig config;
  PlaceMap of_another_size(config, {10, values + 1});
  EXPECT_FALSE(expect_builtin(of_another_size));
  EXPECT_EQ(of_another_size.columns(), 0U);
  EXPECT_EQ(of_another_size.statistics().frames(), 0U);

  MatcherConfig as_they_come;
  as_they_come.standardisation.on = false;
  PlaceMap not_standardised(as_they_come, {10, values});
  EXPECT_FALSE(expect_builtin(not_standardised));

  std::vector<float> descriptor(values, 1.0F);
  ASSERT_TRUE(normalise(descriptor));
  PlaceMap with_statistics(config, {10, values});
  ASSERT_TRUE(with_statistics.learn(descriptor));
  EXPECT_FALSE(expect_builtin(with_statistics));
  EXPECT_EQ(with_statistics.statistics().frames(), 1U);

  PlaceMap with_places(config, {10, values});
  ASSERT_TRUE(with_places.add(descriptor));
  EXPECT_FALSE(expect_builtin(with_places));
}

// What a drive is told of its descriptors is forgotten where a map learns its own.
TEST(ExpectBuiltin, GivesWayToWhatAMapLearns) {
  const MatcherConfig config;
  PlaceMap map(config, {10, values});
  ASSERT_TRUE(expect_builtin(map));
  std::vector<float> descriptor(values, 1.0F);
  ASSERT_TRUE(normalise(descriptor));
  ASSERT_TRUE(map.learn(descriptor));
  EXPECT_EQ(map.statistics().frames(), 1U);
  EXPECT_EQ(map.statistics().mean()[0], static_cast<double>(descriptor[0]));
}

}  // namespace
}  // namespace seqloop::opencv
