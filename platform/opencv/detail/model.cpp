// SPDX-License-Identifier: MIT
#include "opencv/detail/model.hpp"
#include "opencv/detail/one_line.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

#include "opencv/detail/one_line.hpp"
#include "opencv/detail/onnx_outline.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::opencv {
namespace {

constexpr std::string_view node_prefix = "onnx_node!";             // nodes with a name
constexpr std::string_view tensor_prefix = "onnx_node_output_0!";  // nodes without

std::string own_name(std::string_view name) {
  for (const std::string_view prefix : {node_prefix, tensor_prefix})
    if (name.starts_with(prefix)) return std::string(name.substr(prefix.size()));
  return std::string(name);
}

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
  throw SetupError(Fault{name, "OpenCV cannot read it as a model (" + reason + ")",
                         "use a file that OpenCV's dnn module reads: ONNX, Caffe (with its "
                         "prototxt as the second file), TensorFlow, ..."});
}

void check_exists(const std::filesystem::path& path, const std::string& role, Faults& faults) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    faults.push_back({path.string(), "the " + role + " does not exist", "check the name"});
  } else if (!std::filesystem::is_regular_file(status)) {
    faults.push_back({path.string(), "the " + role + " is not a file"});
  } else if (!std::ifstream(path)) {
    faults.push_back({path.string(), "the " + role + " cannot be opened", "check its permissions"});
  }
}

/// A size that a file claims, where it is one that a picture can have.
int picture_size(std::int64_t value) {
  return value > 0 && value <= std::numeric_limits<int>::max() ? static_cast<int>(value) : 0;
}

/// The input as Caffe's and some TensorFlow files declare it.
void read_declared_input(Model& model) {
  std::vector<cv::dnn::MatShape> inputs;
  std::vector<cv::dnn::MatShape> outputs;
  try {
    model.net.getLayerShapes(cv::dnn::MatShape(), 0, inputs, outputs);  // 0: OpenCV's input layer
  } catch (const cv::Exception&) {
    return;  // nothing declared
  }
  if (outputs.empty() || outputs[0].size() != 4) return;
  const cv::dnn::MatShape& shape = outputs[0];
  model.channels = picture_size(shape[1]);
  model.height = picture_size(shape[2]);
  model.width = picture_size(shape[3]);
}

/// The channels that the first convolution's weights [out, in, height, width] ask for.
void read_channels_from_weights(Model& model) {
  for (const std::string& name : model.net.getLayerNames()) {
    const auto layer = model.net.getLayer(model.net.getLayerId(name));
    if (layer->type != "Convolution" || layer->blobs.empty() || layer->blobs[0].dims != 4) continue;
    model.channels = layer->blobs[0].size[1];
    return;
  }
}

}  // namespace

Model load_onnx(std::span<const unsigned char> file, const std::string& name) {
  Model model;
  try {
    model.net = cv::dnn::readNetFromONNX(
        static_cast<const char*>(static_cast<const void*>(file.data())), file.size());
  } catch (const cv::Exception& error) {
    refuse(name, one_line(error.err));
  }
  if (model.net.empty()) refuse(name, "it has no layers");
  OnnxOutline outline = outline_onnx(file);
  if (outline.input_shape.size() == 4) {
    model.channels = picture_size(outline.input_shape[1]);
    model.height = picture_size(outline.input_shape[2]);
    model.width = picture_size(outline.input_shape[3]);
  }
  model.aliases = std::move(outline.node_names);
  if (model.channels == 0) read_channels_from_weights(model);
  return model;
}

Model load_model(const std::filesystem::path& path, const std::filesystem::path& config) {
  Faults faults;
  check_exists(path, "model", faults);
  if (!config.empty()) check_exists(config, "model's configuration", faults);
  if (path.extension() == ".caffemodel" && config.empty()) {
    faults.push_back({path.string(),
                      "its second file, which says what layers there are, is missing",
                      "give its .prototxt as the model's configuration (--config-model)"});
  }
  if (!faults.empty()) throw SetupError(std::move(faults));

  if (path.extension() == ".onnx") {
    std::ifstream stream(path, std::ios::binary);
    const std::vector<char> file{std::istreambuf_iterator<char>(stream), {}};
    const auto bytes = std::as_bytes(std::span(file));
    return load_onnx(
        {static_cast<const unsigned char*>(static_cast<const void*>(bytes.data())), bytes.size()},
        path.string());
  }
  Model model;
  try {
    model.net = cv::dnn::readNet(path.string(), config.string());
  } catch (const cv::Exception& error) {
    refuse(path.string(), one_line(error.err));
  }
  if (model.net.empty()) refuse(path.string(), "it has no layers");
  read_declared_input(model);
  if (model.channels == 0) read_channels_from_weights(model);
  return model;
}

std::string find_layer(const Model& model, const std::string& name) {
  if (name.empty()) return model.net.getLayerNames().back();
  const auto known = [&](const std::string& candidate) {
    return model.net.getLayerId(candidate) > 0;  // 0 is OpenCV's own input layer
  };
  for (const std::string_view prefix : {std::string_view(), node_prefix, tensor_prefix})
    if (std::string candidate = std::string(prefix) + name; known(candidate)) return candidate;
  if (const auto alias = model.aliases.find(name); alias != model.aliases.end())
    if (std::string candidate = std::string(node_prefix) + alias->second; known(candidate))
      return candidate;
  return {};
}

std::vector<std::string> layer_names(const Model& model) {
  std::vector<std::string> names;
  for (const std::string& name : model.net.getLayerNames()) {
    std::string own = own_name(name);
    // OpenCV adds a layer for every output of an ONNX file, often with its node's name.
    if (std::find(names.begin(), names.end(), own) == names.end()) names.push_back(std::move(own));
  }
  return names;
}

}  // namespace seqloop::opencv
