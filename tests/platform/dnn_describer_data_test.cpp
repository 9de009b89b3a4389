// SPDX-License-Identifier: MIT
// The real models of ../shared (environment variable SEQLOOP_SHARED).

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/dnn.hpp>

#include "platform/pictures.hpp"
#include "seqloop/opencv/dnn_describer.hpp"
#include "seqloop/opencv/image_folder_source.hpp"
#include "shared_data.hpp"

namespace seqloop::opencv {
namespace {

struct Case {
  std::string model;
  std::string layer;
  std::string opencv_layer;
  std::size_t size;
  std::size_t most_layers_run;
};

ModelSettings settings_of(const Case& one, const std::filesystem::path& shared) {
  ModelSettings settings;
  settings.layer = one.layer;
  if (one.model == "places365") {
    settings.model = shared / "models/squeezenet11_places365.onnx";
    settings.mean = {104.05F, 112.51F, 116.67F};
    settings.scale = 1.0F / 255.0F;
  } else {
    settings.model =
        shared / "models/squeezenet10_imagenet/squeezenet_v1.0_decompressed.caffemodel";
    settings.config_model = shared / "models/squeezenet10_imagenet/SqueezeNet_deploy.prototxt";
    settings.mean = {104.0F, 117.0F, 123.0F};
  }
  return settings;
}

/// The layer by OpenCV alone: fusion off, its own blob.
std::vector<float> plainly(const Case& one, const ModelSettings& settings, const Image& image) {
  const bool places = one.model == "places365";
  const cv::Size size = places ? cv::Size(224, 224) : cv::Size(227, 227);
  const cv::Mat picture(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.data),
                        image.stride);
  cv::Mat small;
  cv::resize(picture, small, size, 0.0, 0.0, cv::INTER_AREA);
  const auto& mean = settings.mean;
  const cv::Mat blob =
      cv::dnn::blobFromImage(small, static_cast<double>(settings.scale), size,
                             cv::Scalar(static_cast<double>(mean[0]), static_cast<double>(mean[1]),
                                        static_cast<double>(mean[2])));
  cv::dnn::Net net = cv::dnn::readNet(settings.model.string(), settings.config_model.string());
  net.enableFusion(false);
  net.setInput(blob);
  const cv::Mat output = net.forward(one.opencv_layer);
  const double norm = cv::norm(output);
  std::vector<float> unit(output.ptr<float>(), output.ptr<float>() + output.total());
  for (float& value : unit) value = static_cast<float>(static_cast<double>(value) / norm);
  return unit;
}

/// For messages.
void PrintTo(const Case& one, std::ostream* out) { *out << one.model << " " << one.layer; }

class SharedModel : public ::testing::TestWithParam<Case> {};

TEST_P(SharedModel, DescribesAsTheNetWithoutFusionDoes) {
  SEQLOOP_DATA_OR_SKIP(shared);
  const Case& one = GetParam();
  const ModelSettings settings = settings_of(one, shared);
  DnnDescriber describer(settings);
  ASSERT_EQ(describer.size(), one.size);

  ImageFolderSource source(shared / "data/gardens_point/day_left", false);
  Frame frame;
  ASSERT_EQ(source.grab(frame), Grab::frame);
  std::vector<float> descriptor(describer.size());
  ASSERT_EQ(describer.describe(frame.image, descriptor), Description::good);
  const auto wanted = plainly(one, settings, frame.image);
  double squares = 0.0;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    squares += std::pow(static_cast<double>(descriptor[i]) - static_cast<double>(wanted[i]), 2);
  EXPECT_LT(std::sqrt(squares), 1e-4);
  EXPECT_LE(describer.layers_run(), one.most_layers_run);
}

// Layers run, counted by hand: convolutions and poolings up to the layer, the activations and
// concatenations besides where fusion is off; the nets have 68 and 65 layers.
INSTANTIATE_TEST_SUITE_P(
    Layers, SharedModel,
    ::testing::Values(
        Case{"places365", "conv1", "onnx_node!conv1", 64 * 112 * 112, 1},
        Case{"places365", "pool5", "onnx_node!pool5", 256 * 13 * 13, 16},
        Case{"places365", "fire9_concat", "onnx_node!fire9_concat", 512 * 13 * 13, 28},
        Case{"places365", "fire9_expand1x1_relu", "onnx_node!fire9_expand1x1_relu", 256 * 13 * 13,
             58},
        Case{"imagenet", "conv1", "conv1", 96 * 111 * 111, 1},
        Case{"imagenet", "relu_conv1", "relu_conv1", 96 * 111 * 111, 1},
        Case{"imagenet", "fire9/concat", "fire9/concat", 512 * 13 * 13, 28},
        Case{"imagenet", "fire9/relu_conv3x3_2", "fire9/relu_conv3x3_2", 256 * 13 * 13, 60}));

}  // namespace
}  // namespace seqloop::opencv
