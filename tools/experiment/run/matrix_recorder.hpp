// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace seqloop::experiment {

/// Keeps a difference matrix, as it was compared, thinned out to at most 400 columns and rows.
class MatrixRecorder {
 public:
  /// @param columns frames that will come, >= 1
  explicit MatrixRecorder(std::uint64_t columns) noexcept;

  /// The next frame's column. @param column [places]; below zero: not computed
  void add(std::span<const float> column);

  /// Places downwards, frames to the right, dark where they are alike, white where nothing was
  /// computed. @return a PNG file's bytes; none without columns
  [[nodiscard]] std::vector<std::uint8_t> png() const;

 private:
  std::uint64_t step_;
  std::uint64_t frame_ = 0;
  std::vector<std::vector<float>> columns_;
};

}  // namespace seqloop::experiment
