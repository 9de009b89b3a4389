// SPDX-License-Identifier: MIT
// Places-CNN / AlexNet with made-up weights: shapes and what is computed. The numbers are checked
// by tests/house/alexnet.py.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "platform/pictures.hpp"
#include "seqloop/opencv/dnn_describer.hpp"

namespace seqloop::opencv {
namespace {

/// What one layer gives for one picture.
struct Described {
  std::vector<float> descriptor;
  std::size_t layers_run;
};

class AlexNet : public ::testing::Test {
 protected:
  /// Writes net.prototxt and net.caffemodel, without the layers after the last one.
  void make(const std::string& last) const {
    const std::string folder = folder_.path().string();
    // Debian's Python: numpy comes from there.
    const std::string command = "/usr/bin/python3 -B '" SEQLOOP_ALEXNET "' --last " + last +
                                " --prototxt '" + folder + "/net.prototxt' --made-up-weights '" +
                                folder + "/net.caffemodel' >'" + folder + "/words.txt' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << test::read_all(folder_.path() / "words.txt");
  }

  [[nodiscard]] Described describe(const std::string& layer) const {
    ModelSettings settings;
    settings.model = folder_.path() / "net.caffemodel";
    settings.config_model = folder_.path() / "net.prototxt";
    settings.layer = layer;
    settings.mean = {105.0F, 114.0F, 116.0F};
    DnnDescriber describer(settings);
    Described result{std::vector<float>(describer.size()), 0};
    const cv::Mat picture = test::textured(320, 240);
    EXPECT_EQ(describer.describe(test::image_of(picture), result.descriptor), Description::good);
    result.layers_run = describer.layers_run();
    return result;
  }

  test::TemporaryFolder folder_;
};

// The paper's Table 1. The file ends at pool5, so there are no weights of fc6 to fc8.
TEST_F(AlexNet, EveryLayerHasTheSizeOfTable1) {
  make("pool5");
  const std::map<std::string, std::size_t> table{
      {"conv1", 290'400}, {"pool1", 69'984}, {"conv2", 186'624}, {"pool2", 43'264},
      {"conv3", 64'896},  {"conv4", 64'896}, {"conv5", 43'264},  {"pool5", 9'216}};
  for (const auto& [layer, size] : table)
    EXPECT_EQ(describe(layer).descriptor.size(), size) << layer;
  EXPECT_LT(std::filesystem::file_size(folder_.path() / "net.caffemodel"), 10'000'000U);
}

TEST_F(AlexNet, Conv3IsBeforeItsActivationAndRelu3After) {
  make("relu3");
  std::vector<float> rectified = describe("conv3").descriptor;
  EXPECT_LT(*std::min_element(rectified.begin(), rectified.end()), 0.0F);
  double squares = 0.0;
  for (float& value : rectified) {
    value = std::max(value, 0.0F);
    squares += static_cast<double>(value) * static_cast<double>(value);
  }
  const std::vector<float> relu3 = describe("relu3").descriptor;
  ASSERT_EQ(relu3.size(), rectified.size());
  EXPECT_EQ(*std::min_element(relu3.begin(), relu3.end()), 0.0F);
  double error = 0.0;
  for (std::size_t i = 0; i < relu3.size(); ++i)
    error = std::max(error, std::fabs(static_cast<double>(relu3[i]) -
                                      static_cast<double>(rectified[i]) / std::sqrt(squares)));
  EXPECT_LE(error, 1e-7);
}

// The whole file of 231 MB.
TEST_F(AlexNet, LayersAfterTheAskedOneAreNotComputed) {
  make("prob");
  const Described pool5 = describe("pool5");
  EXPECT_EQ(pool5.descriptor.size(), 9'216U);
  EXPECT_EQ(pool5.layers_run, 10U);  // 5 convolutions with their activations, 3 poolings, 2 norms
  const Described fc6 = describe("fc6");
  EXPECT_EQ(fc6.descriptor.size(), 4'096U);
  EXPECT_EQ(fc6.layers_run, 11U);
  EXPECT_EQ(describe("fc7").descriptor.size(), 4'096U);
  EXPECT_EQ(describe("fc8").descriptor.size(), 205U);
}

}  // namespace
}  // namespace seqloop::opencv
