// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace seqloop::opencv {

/// What OpenCV 4.6 forgets about an ONNX file: its input's shape, and the names of the tensors that
/// its nodes make.
struct OnnxOutline {
  std::vector<std::int64_t> input_shape;          ///< of the first real input; 0 where it is free
  std::map<std::string, std::string> node_names;  ///< first output tensor of a node → node
};

/// @param file a whole ONNX file
/// Never fails: what cannot be understood is left out (OpenCV reports it better).
[[nodiscard]] OnnxOutline outline_onnx(std::span<const unsigned char> file);

}  // namespace seqloop::opencv
