// SPDX-License-Identifier: MIT
#include "program/drives/unit_rows.hpp"

#include <cmath>
#include <span>

#include "seqloop/difference.hpp"

namespace seqloop::program {

std::size_t normalise_rows(files::Matrix& matrix) noexcept {
  std::size_t changed = 0;
  for (std::size_t row = 0; row < matrix.rows; ++row) {
    const auto values = std::span(matrix.values).subspan(row * matrix.columns, matrix.columns);
    const double squares = squared_norm(values);
    if (squares == 0.0 || std::abs(squares - 1.0) < 1e-5) continue;
    normalise(values);
    ++changed;
  }
  return changed;
}

}  // namespace seqloop::program
