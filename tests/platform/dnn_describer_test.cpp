// SPDX-License-Identifier: MIT
#include "seqloop/opencv/dnn_describer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/dnn.hpp>

#include "platform/pictures.hpp"

namespace seqloop::opencv {
namespace {

using test::image_of;
using test::textured;

/// 0, 10, ..., 150
const cv::Mat ramp = [] {
  cv::Mat picture(4, 4, CV_8UC1);
  for (int i = 0; i < 16; ++i) picture.data[i] = static_cast<std::uint8_t>(10 * i);
  return picture;
}();

ModelSettings settings_of(const std::string& model, const std::string& layer = "") {
  ModelSettings settings;
  settings.model = std::filesystem::path(SEQLOOP_TEST_DATA) / (model + ".onnx");
  settings.layer = layer;
  return settings;
}

std::vector<float> describe(DnnDescriber& describer, const cv::Mat& picture) {
  std::vector<float> descriptor(describer.size());
  EXPECT_EQ(describer.describe(image_of(picture), descriptor), Description::good);
  return descriptor;
}

std::vector<float> describe(const ModelSettings& settings, const cv::Mat& picture) {
  DnnDescriber describer(settings);
  return describe(describer, picture);
}

/// The features divided by their norm, by the shortest way.
std::vector<float> unit(std::vector<float> features) {
  double squares = 0.0;
  for (const float f : features) squares += static_cast<double>(f) * static_cast<double>(f);
  for (float& f : features) f = static_cast<float>(static_cast<double>(f) / std::sqrt(squares));
  return features;
}

void expect_near(const std::vector<float>& got, const std::vector<float>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  double error = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i)
    error =
        std::max(error, std::fabs(static_cast<double>(got[i]) - static_cast<double>(wanted[i])));
  EXPECT_LE(error, 1e-6);
}

std::vector<float> ramp_times(std::initializer_list<float> factors) {
  std::vector<float> values;
  for (const float factor : factors)
    for (int i = 0; i < 16; ++i) values.push_back(factor * 10.0F * static_cast<float>(i));
  return values;
}

TEST(DnnDescriber, ComputesEveryLayerByItsNodeAndItsTensor) {
  const auto raw = unit(ramp_times({1.0F, -1.0F}));
  const auto active = unit(ramp_times({1.0F, 0.0F}));
  expect_near(describe(settings_of("gray_chain", "conv"), ramp), raw);
  expect_near(describe(settings_of("gray_chain", "c_out"), ramp), raw);
  expect_near(describe(settings_of("gray_chain", "onnx_node!conv"), ramp), raw);
  expect_near(describe(settings_of("gray_chain", "relu"), ramp), active);
  expect_near(describe(settings_of("gray_chain", "r_out"), ramp), active);
  expect_near(describe(settings_of("gray_chain", "p_out"), ramp),
              unit({50, 70, 130, 150, 0, 0, 0, 0}));
  const auto root =
      unit({std::sqrt(50.0F), std::sqrt(70.0F), std::sqrt(130.0F), std::sqrt(150.0F), 0, 0, 0, 0});
  for (const char* name : {"root", "y", ""})
    expect_near(describe(settings_of("gray_chain", name), ramp), root);
}

TEST(DnnDescriber, DoesNotComputeLaterLayers) {
  const auto layers_run = [](const char* layer) {
    DnnDescriber describer(settings_of("gray_chain", layer));
    static_cast<void>(describe(describer, ramp));
    return describer.layers_run();
  };
  EXPECT_EQ(layers_run("conv"), 1U);
  EXPECT_EQ(layers_run("p_out"), 2U);  // convolution with the activation, pooling
  EXPECT_GT(layers_run(""), layers_run("p_out"));
}

// OpenCV 4.6 alone gives wrong values for relu_a and relu_b here.
TEST(DnnDescriber, FusionDoesNotChangeALayer) {
  expect_near(describe(settings_of("fork", "conv_a"), ramp), unit(ramp_times({1, 2})));
  expect_near(describe(settings_of("fork", "relu_a"), ramp), unit(ramp_times({1, 2})));
  expect_near(describe(settings_of("fork", "relu_b"), ramp), unit(ramp_times({3, 4})));
  expect_near(describe(settings_of("fork", "joined"), ramp), unit(ramp_times({1, 2, 3, 4})));
}

TEST(DnnDescriber, MeanIsBgrWhateverTheOrderOfThePlanes) {
  cv::Mat pixel(1, 1, CV_8UC3, cv::Scalar(110, 50, 36));
  ModelSettings settings = settings_of("colour");
  settings.input_width = 1;
  settings.input_height = 1;
  settings.mean = {10.0F, 20.0F, 30.0F};
  settings.scale = 0.5F;
  expect_near(describe(settings, pixel), unit({50, 15, 3}));
  settings.swap_rb = true;
  expect_near(describe(settings, pixel), unit({3, 15, 50}));
  const cv::Mat gray(1, 1, CV_8UC1, cv::Scalar(40));
  settings.swap_rb = false;
  expect_near(describe(settings, gray), unit({15, 10, 5}));
}

TEST(DnnDescriber, SeesWhatBlobFromImageMakes) {
  const cv::Mat picture = textured(7, 5);
  for (const bool swap : {false, true}) {
    ModelSettings settings = settings_of("colour");
    settings.input_width = 9;  // enlarging: blobFromImage interpolates linearly, always
    settings.input_height = 8;
    settings.mean = {104.0F, 117.0F, 123.0F};
    settings.scale = 1.0F / 255.0F;
    settings.swap_rb = swap;
    const cv::Scalar mean = swap ? cv::Scalar(123, 117, 104) : cv::Scalar(104, 117, 123);
    const cv::Mat blob = cv::dnn::blobFromImage(picture, 1.0 / 255.0, cv::Size(9, 8), mean, swap);
    expect_near(describe(settings, picture),
                unit({blob.ptr<float>(), blob.ptr<float>() + blob.total()}));
  }
}

TEST(DnnDescriber, ShrinksByAveraging) {
  cv::Mat large;
  cv::resize(ramp, large, cv::Size(12, 12), 0.0, 0.0, cv::INTER_NEAREST);
  large.at<std::uint8_t>(0, 0) = 90;  // averages to 10 with its eight neighbours of 0
  auto wanted = ramp_times({1.0F, -1.0F});
  wanted[0] = 10.0F;
  wanted[16] = -10.0F;
  expect_near(describe(settings_of("gray_chain", "conv"), large), unit(wanted));
}

TEST(DnnDescriber, MakesColourGreyForAGreyNetAndReadsPaddedRows) {
  const cv::Mat colour = textured(30, 20);
  cv::Mat gray;
  cv::cvtColor(colour, gray, cv::COLOR_BGR2GRAY);
  DnnDescriber describer(settings_of("gray_chain", "conv"));
  EXPECT_TRUE(describer.gray());
  const auto wanted = describe(describer, gray);
  expect_near(describe(describer, colour), wanted);
  cv::Mat padded;
  cv::copyMakeBorder(colour, padded, 3, 3, 5, 5, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  expect_near(describe(describer, padded(cv::Rect(5, 3, 30, 20))), wanted);
  ModelSettings settings = settings_of("colour");
  settings.input_width = settings.input_height = 4;
  EXPECT_FALSE(DnnDescriber(settings).gray());
}

TEST(DnnDescriber, ZeroStaysZeroAndIsFlagged) {
  DnnDescriber describer(settings_of("gray_chain"));
  std::vector<float> descriptor(describer.size(), 9.0F);
  const cv::Mat black(4, 4, CV_8UC1, cv::Scalar(0));
  EXPECT_EQ(describer.describe(image_of(black), descriptor), Description::blank);
  EXPECT_EQ(descriptor, std::vector<float>(describer.size(), 0.0F));
}

// Bad input: pictures and spans that cannot be described; the describer goes on afterwards.
TEST(DnnDescriber, FailsWithoutTouchingTheDescriptor) {
  DnnDescriber describer(settings_of("logarithm"));
  const cv::Mat black(2, 2, CV_8UC1, cv::Scalar(0));
  const cv::Mat good(2, 2, CV_8UC1, cv::Scalar(9));
  const std::vector<float> untouched(4, 9.0F);
  std::vector<float> descriptor = untouched;
  const auto fails = [&](const Image& image, std::span<float> out, std::string_view why) {
    EXPECT_EQ(describer.describe(image, out), Description::failed);
    EXPECT_NE(describer.last_fault().find(why), std::string_view::npos) << describer.last_fault();
    EXPECT_EQ(descriptor, untouched);
  };
  fails(image_of(black), descriptor, "NaN or infinity");
  fails(Image{}, descriptor, "empty");
  fails(image_of(good), std::span(descriptor).first(3), "another length");
  Image thin = image_of(good);
  thin.stride = 1;
  fails(thin, descriptor, "shorter than the picture is wide");
  Image unknown = image_of(good);
  unknown.format = PixelFormat{77};
  fails(unknown, descriptor, "the picture's format is none of its values");
  expect_near(describe(describer, good), {0.5F, 0.5F, 0.5F, 0.5F});
  EXPECT_TRUE(describer.last_fault().empty());
}

TEST(DnnDescriber, TakesAModelFromMemory) {
  ModelSettings settings = settings_of("gray_chain", "relu");
  const std::string file = test::read_all(settings.model);
  const std::vector<unsigned char> bytes(file.begin(), file.end());
  settings.model = "in memory";
  DnnDescriber describer(bytes, settings);
  expect_near(describe(describer, ramp), unit(ramp_times({1.0F, 0.0F})));
}

TEST(DnnDescriber, ReadsACaffeNetWithoutWeights) {
  const test::TemporaryFolder folder;
  ModelSettings settings;
  settings.model = folder.write("pool.prototxt", R"(name: "pool"
input: "data"
input_dim: 1 input_dim: 1 input_dim: 4 input_dim: 4
layer { name: "stage/pool" type: "Pooling" bottom: "data" top: "p"
        pooling_param { pool: AVE kernel_size: 2 stride: 2 } }
layer { name: "later" type: "Power" bottom: "p" top: "q" power_param { shift: 1 } }
)");
  settings.layer = "stage/pool";
  expect_near(describe(settings, ramp), unit({25, 45, 105, 125}));
  settings.layer = "later";
  expect_near(describe(settings, ramp), unit({26, 46, 106, 126}));
}

TEST(DnnDescriber, NeedsColourWhereTheNetSeesIt) {
  ModelSettings settings = settings_of("colour");
  settings.input_width = 5;
  settings.input_height = 3;
  const PictureNeeds needs = DnnDescriber(settings).needs();
  EXPECT_EQ(needs.width, 5);
  EXPECT_EQ(needs.height, 3);
  EXPECT_FALSE(needs.gray_is_enough);
  EXPECT_TRUE(DnnDescriber(settings_of("gray_chain")).needs().gray_is_enough);
}

}  // namespace
}  // namespace seqloop::opencv
