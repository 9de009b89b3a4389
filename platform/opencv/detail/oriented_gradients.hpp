// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop::opencv {

/// The built-in descriptor's filters, stage by stage as platform/opencv/model/make_builtin.py says,
/// in the fixed order that makes the same bytes on every processor. As a net in OpenCV it takes
/// several times as long, and allocates.
class OrientedGradients {
 public:
  static constexpr int width = 256;  // pixels
  static constexpr int height = 128;
  static constexpr std::size_t size = 735;  // orientation x row x column, 15 x 7 x 7
  static constexpr std::size_t grid_columns = 7;

  OrientedGradients() noexcept;

  /// @param pixels [height, width] grey, rows `stride` bytes apart
  /// @param values [size] written, each 0..1; zeros where nothing is to be seen
  /// Work: 6,840 tensors, 15 orientations of each. Allocates: never.
  void describe(const std::uint8_t* pixels, std::size_t stride, std::span<float> values) noexcept;

 private:
  static constexpr int tensor_rows = 57;
  static constexpr int tensor_columns = 120;
  static constexpr int orientations = 15;
  static constexpr int cells = grid_columns;  // in a row and in a column

  /// A value of each orientation, and one of padding.
  using Orientations = std::array<float, orientations + 1>;

  /// The structure tensor Jxx, Jyy, Jxx + 2 Jxy + Jyy by the root of its energy.
  struct Tensor {
    float xx;
    float yy;
    float sum;
  };

  void find_tensors(const std::uint8_t* pixels, std::size_t stride, int row) noexcept;
  void add_edges(int first, int last, Orientations& sums) const noexcept;
  void add_row(int row) noexcept;

  Orientations of_xx_;  ///< weights of a tensor's parts
  Orientations of_yy_;
  Orientations of_sum_;
  std::array<Tensor, tensor_columns> tensors_{};              ///< of one row
  std::array<std::array<Orientations, cells>, cells> cells_;  ///< sums of edges
};

}  // namespace seqloop::opencv
