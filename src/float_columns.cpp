// SPDX-License-Identifier: MIT
#include "seqloop/detail/float_columns.hpp"

#include <algorithm>

#include "kernels/lane_squares.hpp"
#include "kernels/variants.hpp"

namespace seqloop {
namespace kernels {
namespace {

bool always() noexcept { return true; }

}  // namespace

constinit const FloatColumn float_plain{"plain", &always, &lane_squares, &lane_squares_block};

}  // namespace kernels

const FloatColumn& best_float_column() noexcept {
  // The last one is in plain C++, so that one is always found.
  return **std::ranges::find_if(float_columns(),
                                [](const FloatColumn* column) { return column->supported(); });
}

}  // namespace seqloop
