// SPDX-License-Identifier: MIT
#include "seqloop/opencv/bag_of_words.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>

#include "expect_setup_error.hpp"
#include "synthetic_drive.hpp"

namespace seqloop::opencv {
namespace {

using test::image_of;
using test::SyntheticDrive;

/// Boxes with corners that ORB sees.
cv::Mat scene(std::uint64_t seed, int width = 320, int height = 240) {
  cv::Mat picture(height, width, CV_8UC1, cv::Scalar(128));
  cv::RNG random(seed);
  for (int box = 0; box < 60; ++box) {
    const cv::Point corner(random.uniform(0, width), random.uniform(0, height));
    const cv::Size size(random.uniform(5, 40), random.uniform(5, 40));
    cv::rectangle(picture, cv::Rect(corner, size), cv::Scalar(random.uniform(0, 256)), cv::FILLED);
  }
  return picture;
}

std::vector<cv::Mat> drive(std::uint64_t first, std::size_t count) {
  std::vector<cv::Mat> pictures;
  for (std::uint64_t i = 0; i < count; ++i) pictures.push_back(scene(first + i));
  return pictures;
}

BagOfWords trained(const std::vector<cv::Mat>& pictures, std::size_t words) {
  SyntheticDrive source(pictures);
  const std::array<FrameSource*, 1> training{&source};
  return BagOfWords(training, words);
}

std::vector<float> describe(BagOfWords& describer, const cv::Mat& picture,
                            Description wanted = Description::good) {
  std::vector<float> descriptor(describer.size());
  EXPECT_EQ(describer.describe(image_of(picture), descriptor), wanted) << describer.last_fault();
  return descriptor;
}

double product(const std::vector<float>& a, const std::vector<float>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

TEST(BagOfWords, TrainedTwiceGivesTheSameBytes) {
  const auto pictures = drive(1, 6);
  BagOfWords one = trained(pictures, 50);
  ASSERT_EQ(one.size(), 50U);
  cv::theRNG().state = 12345;  // what others drew must not matter, nor be disturbed
  BagOfWords other = trained(pictures, 50);
  EXPECT_EQ(cv::theRNG().state, 12345U);
  for (const cv::Mat& picture : pictures) {
    const auto values = describe(one, picture);
    EXPECT_EQ(values, describe(one, picture));
    EXPECT_EQ(values, describe(other, picture));
    EXPECT_NEAR(product(values, values), 1.0, 1e-5);
  }
}

TEST(BagOfWords, RecognisesAShiftedPictureAmongOthers) {
  BagOfWords describer = trained(drive(1, 20), 200);
  const auto places = drive(100, 10);
  for (std::size_t query = 0; query < places.size(); ++query) {
    cv::Mat shifted;
    cv::copyMakeBorder(places[query](cv::Rect(0, 0, 305, 230)), shifted, 10, 0, 15, 0,
                       cv::BORDER_REPLICATE);
    cv::cvtColor(shifted, shifted, cv::COLOR_GRAY2BGR);
    const auto values = describe(describer, shifted);
    std::vector<double> likeness;
    for (const cv::Mat& place : places)
      likeness.push_back(product(values, describe(describer, place)));
    EXPECT_EQ(std::ranges::max_element(likeness) - likeness.begin(),
              static_cast<std::ptrdiff_t>(query));
  }
}

// With a word for every feature, the words are the features: counts and weights can be told.
TEST(BagOfWords, WeighsWordsByHowRareTheyAre) {
  const auto orb = cv::ORB::create(500);
  const std::vector<cv::Mat> pictures{scene(1, 110, 110), scene(2, 110, 110), scene(1, 110, 110)};
  std::vector<std::vector<std::string>> features;
  std::vector<std::string> all;
  for (const cv::Mat& picture : pictures) {
    std::vector<cv::KeyPoint> points;
    cv::Mat found;
    orb->detectAndCompute(picture, cv::noArray(), points, found);
    features.emplace_back();
    for (int row = 0; row < found.rows; ++row)
      features.back().emplace_back(found.ptr(row), found.ptr(row) + 32);
    all.insert(all.end(), features.back().begin(), features.back().end());
  }
  std::vector<std::string> distinct = all;
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  ASSERT_GT(distinct.size(), 10U);
  BagOfWords describer = trained(pictures, distinct.size());
  std::vector<double> wanted;  // of the second picture's words, in any order
  for (const std::string& word : distinct) {
    const auto count = std::ranges::count(features[1], word);
    double having = 0.0;
    for (const auto& words : features) having += std::ranges::count(words, word) > 0 ? 1.0 : 0.0;
    wanted.push_back(static_cast<double>(count) * std::log(3.0 / having));
  }
  const double norm =
      std::sqrt(std::inner_product(wanted.begin(), wanted.end(), wanted.begin(), 0.0));
  auto got = describe(describer, pictures[1]);
  std::ranges::sort(got);
  std::ranges::sort(wanted);
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], wanted[i] / norm, 1e-5);
}

TEST(BagOfWords, APictureWithoutAFeatureIsBlank) {
  BagOfWords describer = trained(drive(1, 4), 100);
  const std::vector<float> zero(100, 0.0F);
  EXPECT_EQ(describe(describer, cv::Mat(240, 320, CV_8UC1, cv::Scalar(9)), Description::blank),
            zero);
  EXPECT_EQ(describe(describer, scene(1, 64, 32), Description::blank), zero);
  std::vector<float> descriptor(100);
  EXPECT_EQ(describer.describe({}, descriptor), Description::failed);
  EXPECT_EQ(describer.last_fault(), "the picture is empty");
}

// Bad input: drives without enough to learn from.
TEST(BagOfWords, StopsLearningWhenItIsToldTo) {
  // Six pictures, 19 rounds, and the pictures again, of which words are counted.
  for (const int last : {1, 10, 26, 31}) {
    SyntheticDrive source(drive(1, 6));
    const std::array<FrameSource*, 1> training{&source};
    int calls = 0;
    const auto stop = [&] {
      if (++calls == last) throw std::runtime_error("enough");
    };
    EXPECT_THROW(BagOfWords(training, 50, stop), std::runtime_error);
    EXPECT_EQ(calls, last);
  }
}

TEST(BagOfWords, RefusesWhatItCannotLearnFrom) {
  using test::says;
  const auto fault = [](const std::vector<cv::Mat>& pictures, std::size_t words) {
    return test::setup_error([&] { trained(pictures, words); });
  };
  const std::string many = fault({scene(1), {}, scene(2)}, 1001);
  EXPECT_TRUE(says(many, "1001 cannot be learned from the "));
  EXPECT_TRUE(says(many, "2 pictures that can be read and 1 that cannot"));
  EXPECT_TRUE(says(fault(drive(1, 2), 0), "words: 0 cannot be learned"));
  EXPECT_TRUE(says(fault({scene(1, 64, 32)}, 1), "from the 0 features"));
  EXPECT_TRUE(says(fault({}, 1), "0 pictures"));
  EXPECT_TRUE(says(fault(drive(1, 1), 5), "every training picture has each of them"));
}

TEST(BagOfWords, NeedsGrayPicturesAsTheyCome) {
  const PictureNeeds needs = trained(drive(1, 6), 50).needs();
  EXPECT_EQ(needs.width, 0);
  EXPECT_EQ(needs.height, 0);
  EXPECT_TRUE(needs.gray_is_enough);
}

}  // namespace
}  // namespace seqloop::opencv
