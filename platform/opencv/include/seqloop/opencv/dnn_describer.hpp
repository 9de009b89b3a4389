// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "seqloop/describer.hpp"

namespace seqloop::opencv {

/// Which layer of which net makes the descriptor, and what the net wants to see.
struct ModelSettings {
  std::filesystem::path model;         ///< any file that OpenCV's dnn module reads
  std::filesystem::path config_model;  ///< Caffe's prototxt and the like; empty: none needed
  std::string layer;            ///< as the model file names it; empty: the last one of the file
  int input_width = 0;          ///< pixels; 0: as the model file says
  int input_height = 0;         ///< pixels; 0: as the model file says
  std::array<float, 3> mean{};  ///< subtracted; B, G, R whatever `swap_rb`, grey levels 0..255
  float scale = 1.0F;           ///< multiplied after that; not 0
  bool swap_rb = false;         ///< the net wants R, G, B planes instead of B, G, R
};

/// The output of one layer of a neural net, flattened in C, H, W order and divided by its L2 norm
/// (Algorithm 1). Layers that come after the asked one in the file are not computed.
///
/// Pictures are made grey where the net has one input channel, brought to the input's size by
/// averaging (shrinking) or linearly (enlarging), and become `(pixel - mean) * scale`.
///
/// ONNX layers are named by node or by the node's first output tensor. Caffe layers that work in
/// place (ReLU) have a name of their own: `conv3` is the convolution's output, `relu3` what Caffe's
/// blob `conv3` holds at the end.
///
/// OpenCV computes with the threads that the process allows it (cv::setNumThreads, never called
/// here), and allocates in every call.
class DnnDescriber : public Describer {
 public:
  /// Loads the net, finds D, and runs it once, so that the first frame costs what the others cost.
  /// Where OpenCV's fusion of layers changes the layer's values, it is switched off.
  /// Throws SetupError with every fault found: files, layer, channels, input size, mean, scale.
  explicit DnnDescriber(const ModelSettings& settings);

  /// @param onnx a whole ONNX file; `settings.model` only names it in messages
  DnnDescriber(std::span<const unsigned char> onnx, const ModelSettings& settings);

  DnnDescriber(const DnnDescriber&) = delete;
  DnnDescriber& operator=(const DnnDescriber&) = delete;
  DnnDescriber(DnnDescriber&&) = delete;
  DnnDescriber& operator=(DnnDescriber&&) = delete;
  ~DnnDescriber() override;

  [[nodiscard]] std::size_t size() const noexcept override;

  /// The net's input size, and whether the net sees grey only.
  [[nodiscard]] PictureNeeds needs() const noexcept override;

  /// `failed` for an empty picture, a span that is not [D], an exception of OpenCV, and a layer
  /// that gives NaN or infinity. Allocates: OpenCV does; nothing here once the picture size has
  /// been seen.
  [[nodiscard]] Description describe(const Image& image,
                                     std::span<float> descriptor) noexcept override;

  [[nodiscard]] std::string_view last_fault() const noexcept override;

  /// The net sees grey only, so grey pictures are enough.
  [[nodiscard]] bool gray() const noexcept;

  /// Pixels of the pictures that the net sees.
  [[nodiscard]] int input_width() const noexcept;
  [[nodiscard]] int input_height() const noexcept;

  /// Layers that the last call computed (fused ones count as one).
  [[nodiscard]] std::size_t layers_run() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
