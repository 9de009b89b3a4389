// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <limits>

#include "expect_setup_error.hpp"
#include "platform/pictures.hpp"
#include "seqloop/opencv/dnn_describer.hpp"

namespace seqloop::opencv {
namespace {

using test::says;
using test::setup_error;
using test::TemporaryFolder;

ModelSettings settings_of(const std::string& model) {
  ModelSettings settings;
  settings.model = std::filesystem::path(SEQLOOP_TEST_DATA) / (model + ".onnx");
  return settings;
}

/// What building a describer says; OpenCV must not write to stderr besides. (The protocol buffer
/// library does, for a prototxt that it cannot read.)
std::string fault_of(const ModelSettings& settings) {
  ::testing::internal::CaptureStderr();
  const std::string fault = setup_error([&] { DnnDescriber describer(settings); });
  const std::string chatter = ::testing::internal::GetCapturedStderr();
  if (settings.model.extension() != ".prototxt") {
    EXPECT_EQ(chatter, "");
  }
  return fault;
}

// Bad input: files that are not there, both named at once.
TEST(DnnDescriberFault, MissingFiles) {
  const TemporaryFolder folder;
  ModelSettings settings;
  settings.model = folder.path() / "none.caffemodel";
  settings.config_model = folder.path() / "none.prototxt";
  settings.scale = 0.0F;
  const std::string fault = fault_of(settings);
  EXPECT_TRUE(says(fault, "none.caffemodel: the model does not exist"));
  EXPECT_TRUE(says(fault, "none.prototxt: the model's configuration does not exist"));
  EXPECT_TRUE(says(fault, "scale: is zero"));
  settings.model = folder.path();
  EXPECT_TRUE(says(fault_of(settings), "the model is not a file"));
  settings.model.clear();
  EXPECT_TRUE(says(fault_of(settings), "the model does not exist"));
}

// Bad input: files that are no models.
TEST(DnnDescriberFault, NotAModel) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.onnx", "a.caffemodel", "a.prototxt", "a.pb", "a.txt", "a"}) {
    for (const char* content : {"", "hello, world\n"}) {
      ModelSettings settings;
      settings.model = folder.write(name, content);
      const bool needs_second = name == "a.caffemodel";
      EXPECT_TRUE(says(fault_of(settings),
                       needs_second ? "its second file" : "OpenCV cannot read it as a model"))
          << name;
    }
  }
}

// Bad input: a model that was cut off.
TEST(DnnDescriberFault, TruncatedModel) {
  const TemporaryFolder folder;
  const std::string whole = test::read_all(settings_of("gray_chain").model);
  for (const std::size_t length : {whole.size() - 1, whole.size() / 2, std::size_t{10}}) {
    ModelSettings settings;
    settings.model = folder.write("cut.onnx", whole.substr(0, length));
    EXPECT_FALSE(fault_of(settings).empty());
  }
}

// Bad input: a layer that the model does not have; OpenCV's own input layer is none.
TEST(DnnDescriberFault, UnknownLayerListsThoseThereAre) {
  ModelSettings settings = settings_of("gray_chain");
  for (const char* layer : {"conv3", "_input", "w", "x"}) {
    settings.layer = layer;
    EXPECT_TRUE(says(fault_of(settings), std::string("has no layer '") + layer +
                                             "'; its layers are: conv, relu, p_out, root, y"));
  }
}

// Bad input: a net that sees no pictures, and one that does not say how large they are.
TEST(DnnDescriberFault, ChannelsAndSizes) {
  EXPECT_TRUE(says(fault_of(settings_of("four_channels")), "wants 4 channels"));
  EXPECT_TRUE(says(fault_of(settings_of("colour")), "does not say which input size it wants"));
  ModelSettings settings = settings_of("gray_chain");
  for (const auto& [width, height] :
       std::vector<std::pair<int, int>>{{4, 0}, {0, 4}, {-1, 4}, {4, 100'000}}) {
    settings.input_width = width;
    settings.input_height = height;
    EXPECT_TRUE(says(fault_of(settings), "is no size"));
  }
  settings.input_width = settings.input_height = 1;  // the pooling has nothing to pool
  EXPECT_TRUE(says(fault_of(settings), "cannot be computed on 1x1x1 values"));
}

// Bad input: several at once.
TEST(DnnDescriberFault, EveryFaultIsNamed) {
  ModelSettings settings = settings_of("four_channels");
  settings.layer = "none";
  settings.mean[1] = std::numeric_limits<float>::quiet_NaN();
  settings.scale = std::numeric_limits<float>::infinity();
  settings.input_width = 7;
  const std::string fault = fault_of(settings);
  for (const char* part : {"mean: is not finite", "scale: is zero or not finite", "7x0 is no size",
                           "has no layer 'none'", "wants 4 channels"})
    EXPECT_TRUE(says(fault, part));
}

// Bad input: a Caffe net whose weights are not there.
TEST(DnnDescriberFault, WeightsMissing) {
  const TemporaryFolder folder;
  ModelSettings settings;
  settings.model = folder.write("conv.prototxt", R"(name: "conv"
input: "data"
input_dim: 1 input_dim: 1 input_dim: 4 input_dim: 4
layer { name: "conv1" type: "Convolution" bottom: "data" top: "c"
        convolution_param { num_output: 2 kernel_size: 3 } }
)");
  EXPECT_TRUE(says(fault_of(settings), "check the input size, and that the model's weights"));
}

}  // namespace
}  // namespace seqloop::opencv
