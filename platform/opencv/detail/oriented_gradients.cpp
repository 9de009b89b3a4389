// SPDX-License-Identifier: MIT
#include "opencv/detail/oriented_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seqloop::opencv {
namespace {

constexpr double selectivity = 0.7;
constexpr float epsilon = 1.0F;  // squared grey levels
constexpr int tensor_step = 2;   // pixels

// A cell is 9 x 24 tensors, every 8 x 16: along a row, a block of 16 and the first 8 of the next
// one. Columns begin at the fourth tensor: as many are left out on the left as on the right.
constexpr int cell_rows = 9;
constexpr int cell_row_step = 8;
constexpr int cell_columns = 24;
constexpr int block = 16;
constexpr int overlap = cell_columns - block;
constexpr std::size_t first_tensor = 3;

/// As the net's file has it, so that no digit depends on a library's sine.
float rounded(double weight) { return static_cast<float>(std::round(weight * 1e6) / 1e6); }

}  // namespace

OrientedGradients::OrientedGradients() noexcept : of_xx_{}, of_yy_{}, of_sum_{}, cells_{} {
  for (std::size_t i = 0; i < orientations; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / orientations;
    of_xx_[i] = rounded(std::cos(angle) - std::sin(angle) - selectivity);
    of_yy_[i] = rounded(-std::cos(angle) - std::sin(angle) - selectivity);
    of_sum_[i] = rounded(std::sin(angle));
  }
}

/// Central differences, squared and averaged over 3 x 3 pixels. Differences are kept twice as
/// large, so that their squares add up in whole numbers.
void OrientedGradients::find_tensors(const std::uint8_t* pixels, std::size_t stride,
                                     int row) noexcept {
  constexpr std::size_t columns = width - 2;
  std::array<std::int32_t, columns> xx{};
  std::array<std::int32_t, columns> yy{};
  std::array<std::int32_t, columns> sum{};
  for (int window_row = 0; window_row < 3; ++window_row) {
    const std::uint8_t* above =
        pixels + static_cast<std::size_t>(tensor_step * row + window_row) * stride;
    const std::uint8_t* here = above + stride;
    const std::uint8_t* below = here + stride;
    for (std::size_t x = 0; x < columns; ++x) {
      const std::int32_t dx = here[x + 2] - here[x];
      const std::int32_t dy = below[x + 1] - above[x + 1];
      xx[x] += dx * dx;
      yy[x] += dy * dy;
      sum[x] += (dx + dy) * (dx + dy);
    }
  }
  constexpr float mean = 1.0F / (4 * 9);
  for (std::size_t i = 0; i < tensor_columns; ++i) {
    const std::size_t x = tensor_step * (first_tensor + i);
    const float jxx = mean * static_cast<float>(xx[x] + xx[x + 1] + xx[x + 2]);
    const float jyy = mean * static_cast<float>(yy[x] + yy[x + 1] + yy[x + 2]);
    const float all = mean * static_cast<float>(sum[x] + sum[x + 1] + sum[x + 2]);
    const float root = std::sqrt(jxx + jyy + epsilon);
    tensors_[i] = {jxx / root, jyy / root, all / root};
  }
}

/// Of the row's tensors from the first to before the last.
void OrientedGradients::add_edges(int first, int last, Orientations& sums) const noexcept {
  for (int i = first; i < last; ++i) {
    const Tensor& tensor = tensors_[static_cast<std::size_t>(i)];
    for (std::size_t o = 0; o < sums.size(); ++o) {
      const float edge = of_xx_[o] * tensor.xx + of_yy_[o] * tensor.yy + of_sum_[o] * tensor.sum;
      sums[o] += edge > 0.0F ? edge : 0.0F;
    }
  }
}

/// Adds a row of tensors to the cells that it lies in.
void OrientedGradients::add_row(int row) noexcept {
  const int newest = row / cell_row_step;
  const int oldest = row % cell_row_step < cell_rows - cell_row_step ? newest - 1 : newest;
  for (int b = 0; b <= cells; ++b) {
    Orientations shared{};
    Orientations own{};
    add_edges(b * block, b * block + overlap, shared);
    if (b < cells) add_edges(b * block + overlap, (b + 1) * block, own);
    for (int i = std::max(oldest, 0); i <= std::min(newest, cells - 1); ++i) {
      auto& of_row = cells_[static_cast<std::size_t>(i)];
      for (std::size_t o = 0; o < shared.size(); ++o) {
        if (b > 0) of_row[static_cast<std::size_t>(b - 1)][o] += shared[o];
        if (b < cells) of_row[static_cast<std::size_t>(b)][o] += shared[o] + own[o];
      }
    }
  }
}

void OrientedGradients::describe(const std::uint8_t* pixels, std::size_t stride,
                                 std::span<float> values) noexcept {
  cells_ = {};
  for (int row = 0; row < tensor_rows; ++row) {
    find_tensors(pixels, stride, row);
    add_row(row);
  }
  constexpr float mean = 1.0F / (cell_rows * cell_columns);
  for (std::size_t i = 0; i < std::size_t{cells} * cells; ++i) {
    const Orientations& edges = cells_[i / cells][i % cells];
    float power = epsilon;
    for (const float edge : edges) power += mean * edge * (mean * edge);
    const float root = std::sqrt(power);
    for (std::size_t o = 0; o < orientations; ++o)
      values[o * cells * cells + i] = std::sqrt(mean * edges[o] / root);
  }
}

}  // namespace seqloop::opencv
