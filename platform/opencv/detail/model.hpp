// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/dnn.hpp>
#include <span>
#include <string>
#include <vector>

namespace seqloop::opencv {

/// A net and what its file says about it.
struct Model {
  cv::dnn::Net net;
  int channels = 0;                            ///< of the input; 0: the file does not tell
  int width = 0;                               ///< likewise, pixels
  int height = 0;                              ///< likewise, pixels
  std::map<std::string, std::string> aliases;  ///< further names of layers → the names in the file
};

/// @param config the second file of a format that needs one (Caffe's prototxt), else empty
/// Throws SetupError: files missing, files that OpenCV cannot read as a model.
[[nodiscard]] Model load_model(const std::filesystem::path& model,
                               const std::filesystem::path& config);

/// @param file a whole ONNX file
/// @param name for messages
[[nodiscard]] Model load_onnx(std::span<const unsigned char> file, const std::string& name);

/// OpenCV's name of a layer that is named as in the model file; empty where there is none.
/// @param name a layer (ONNX: a node), or for ONNX the tensor that a node makes first; empty: the
///   last layer
[[nodiscard]] std::string find_layer(const Model& model, const std::string& name);

/// Names of all layers as the model file has them, in order.
[[nodiscard]] std::vector<std::string> layer_names(const Model& model);

}  // namespace seqloop::opencv
