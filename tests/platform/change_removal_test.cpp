// SPDX-License-Identifier: MIT
#include "seqloop/opencv/change_removal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "expect_setup_error.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "synthetic_drive.hpp"

namespace seqloop::opencv {
namespace {

using test::image_of;
using test::SyntheticDrive;
using test::textured;

/// 4x4 grey; its layer conv is the picture and the picture negated.
std::unique_ptr<DnnDescriber> gray_net() {
  ModelSettings settings;
  settings.model = SEQLOOP_TEST_DATA "/gray_chain.onnx";
  settings.layer = "conv";
  return std::make_unique<DnnDescriber>(settings);
}

/// Sees colour, a pixel of it.
std::unique_ptr<DnnDescriber> colour_net() {
  ModelSettings settings;
  settings.model = SEQLOOP_TEST_DATA "/colour.onnx";
  settings.input_width = settings.input_height = 1;
  return std::make_unique<DnnDescriber>(settings);
}

ChangeRemoval trained(std::unique_ptr<DnnDescriber> net, const std::vector<cv::Mat>& pictures,
                      std::size_t components) {
  SyntheticDrive drive(pictures);
  const std::array<FrameSource*, 1> training{&drive};
  return {std::move(net), training, components};
}

std::vector<float> describe(Describer& describer, const cv::Mat& picture) {
  std::vector<float> descriptor(describer.size());
  EXPECT_EQ(describer.describe(image_of(picture), descriptor), Description::good)
      << describer.last_fault();
  return descriptor;
}

std::vector<int> last_picture(const ChangeRemoval& describer) {
  const Image image = describer.last_picture();
  const int bytes = image.width * image.height * (image.format == PixelFormat::gray8 ? 1 : 3);
  return {image.data, image.data + bytes};
}

/// 4x4 pixels with one value at the top left and another below it.
cv::Mat pair_picture(int first, int second) {
  cv::Mat picture = cv::Mat::zeros(4, 4, CV_8UC1);
  picture.at<std::uint8_t>(0, 0) = static_cast<std::uint8_t>(first);
  picture.at<std::uint8_t>(1, 0) = static_cast<std::uint8_t>(second);
  return picture;
}

// The drive varies along (3, 4) / 5 around (100, 100).
TEST(ChangeRemoval, ShowsTheNetWhatIsLeftOfAPicture) {
  ChangeRemoval describer =
      trained(gray_net(), {pair_picture(70, 60), {}, pair_picture(130, 140)}, 1);
  EXPECT_EQ(describer.components(), 1U);
  EXPECT_EQ(describer.size(), 32U);
  const auto values = describe(describer, pair_picture(200, 50));
  // (100, -50) has 20 along it: (200, 50) - 20 * (3, 4) / 5 = (188, 34)
  std::vector<int> wanted(16, 0);
  wanted[0] = 188;
  wanted[4] = 34;
  EXPECT_EQ(last_picture(describer), wanted);
  const double norm = std::sqrt(2.0 * (188.0 * 188.0 + 34.0 * 34.0));
  EXPECT_NEAR(values[0], 188.0 / norm, 1e-6);
  EXPECT_NEAR(values[20], -34.0 / norm, 1e-6);
}

TEST(ChangeRemoval, OfNothingIsTheNetItself) {
  const cv::Mat picture = textured(300, 200);
  const auto net = make_builtin_net();
  ChangeRemoval describer =
      trained(make_builtin_net(), {textured(40, 30, 5), textured(40, 30, 6)}, 0);
  EXPECT_EQ(describe(describer, picture), describe(*net, picture));
}

TEST(ChangeRemoval, OfEverythingMakesTrainingPicturesAlike) {
  std::vector<cv::Mat> pictures;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) pictures.push_back(textured(300, 200, seed));
  ChangeRemoval describer = trained(make_builtin_net(), pictures, 3);
  static_cast<void>(describe(describer, pictures[0]));
  const auto first = last_picture(describer);
  for (const cv::Mat& picture : pictures) {
    static_cast<void>(describe(describer, picture));
    const auto other = last_picture(describer);
    for (std::size_t i = 0; i < first.size(); ++i) ASSERT_NEAR(first[i], other[i], 1);
  }
}

TEST(ChangeRemoval, MixesGreyAndColourAndSeveralDrives) {
  const auto pixel = [](int b, int g, int r) {
    return cv::Mat(1, 1, CV_8UC3, cv::Scalar(b, g, r));
  };
  SyntheticDrive gray(std::vector{cv::Mat(2, 2, CV_8UC1, cv::Scalar(50))});
  SyntheticDrive colour(std::vector{pixel(150, 150, 150)});
  const std::array<FrameSource*, 2> training{&gray, &colour};
  ChangeRemoval describer(colour_net(), training, 1);  // brightness, around 100
  static_cast<void>(describe(describer, pixel(130, 110, 90)));
  EXPECT_EQ(last_picture(describer), (std::vector<int>{120, 100, 80}));
  static_cast<void>(describe(describer, cv::Mat(1, 1, CV_8UC1, cv::Scalar(250))));
  EXPECT_EQ(last_picture(describer), (std::vector<int>{100, 100, 100}));
}

TEST(ChangeRemoval, SaysHowManyComponentsThereAre) {
  const std::vector<cv::Mat> pictures{pair_picture(1, 0), pair_picture(2, 0), pair_picture(9, 0)};
  EXPECT_EQ(trained(gray_net(), pictures, 2).components(), 1U);
}

// Bad input: too few pictures, too many, none that can be described.
TEST(ChangeRemoval, StopsLearningWhenItIsToldTo) {
  // Three pictures, their products, and the components.
  for (const int last : {1, 3, 4, 5}) {
    SyntheticDrive drive({pair_picture(1, 2), pair_picture(3, 4), pair_picture(9, 2)});
    const std::array<FrameSource*, 1> training{&drive};
    int calls = 0;
    const auto stop = [&] {
      if (++calls == last) throw std::runtime_error("enough");
    };
    EXPECT_THROW(ChangeRemoval(gray_net(), training, 1, stop), std::runtime_error) << last;
    EXPECT_EQ(calls, last);
  }
}

TEST(ChangeRemoval, RefusesWhatItCannotLearnFrom) {
  using test::says;
  const auto fault = [](const std::vector<cv::Mat>& pictures, std::size_t components) {
    return test::setup_error([&] { trained(gray_net(), pictures, components); });
  };
  const std::string few = fault({pair_picture(1, 2), {}, {}, pair_picture(3, 4)}, 2);
  EXPECT_TRUE(says(few, "2 pictures that can be read and 2 that cannot"));
  EXPECT_TRUE(says(few, "too few to remove 2 components"));
  EXPECT_TRUE(says(fault({{}}, 0), "0 pictures"));
  EXPECT_TRUE(says(fault({}, 0), "0 pictures"));
  EXPECT_TRUE(says(fault(std::vector<cv::Mat>(1001, pair_picture(1, 2)), 1), "more than 1000"));
  EXPECT_EQ(trained(gray_net(), std::vector<cv::Mat>(1000, pair_picture(1, 2)), 1).components(),
            0U);
}

TEST(ChangeRemoval, FailsAndIsBlankAsTheNetIs) {
  ChangeRemoval describer = trained(gray_net(), {pair_picture(1, 2), pair_picture(3, 4)}, 0);
  std::vector<float> descriptor(describer.size());
  EXPECT_EQ(describer.describe({}, descriptor), Description::failed);
  EXPECT_EQ(describer.last_fault(), "the picture is empty");
  const cv::Mat black = cv::Mat::zeros(4, 4, CV_8UC1);
  EXPECT_EQ(describer.describe(image_of(black), descriptor), Description::blank);
  EXPECT_EQ(describer.last_fault(), "");
}

TEST(ChangeRemoval, NeedsWhatTheNetNeeds) {
  const std::vector<cv::Mat> pictures{pair_picture(0, 10), pair_picture(10, 0)};
  const PictureNeeds gray = trained(gray_net(), pictures, 0).needs();
  EXPECT_EQ(gray.width, 4);
  EXPECT_EQ(gray.height, 4);
  EXPECT_TRUE(gray.gray_is_enough);
  EXPECT_FALSE(trained(colour_net(), pictures, 0).needs().gray_is_enough);
}

}  // namespace
}  // namespace seqloop::opencv
