// SPDX-License-Identifier: MIT
#include "seqloop/detail/float_columns.hpp"

#include <algorithm>

#include "kernels/variants.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace kernels {
namespace {

bool always() noexcept { return true; }

void squares(const float* query, const float* rows, std::size_t stride, std::size_t count,
             double* sums) noexcept {
  const std::span<const float> a(query, stride);
  for (std::size_t row = 0; row < count; ++row) {
    sums[row] = squared_distance(a, {rows + row * stride, stride});
  }
}

void squares_block(const float* queries, std::size_t queries_count, const float* rows,
                   std::size_t stride, std::size_t count, double* sums,
                   std::size_t out_stride) noexcept {
  for (std::size_t query = 0; query < queries_count; ++query) {
    squares(queries + query * stride, rows, stride, count, sums + query * out_stride);
  }
}

}  // namespace

constinit const FloatColumn float_plain{"plain", &always, &squares, &squares_block};

}  // namespace kernels

const FloatColumn& best_float_column() noexcept {
  // The last one is in plain C++, so that one is always found.
  return **std::ranges::find_if(float_columns(),
                                [](const FloatColumn* column) { return column->supported(); });
}

}  // namespace seqloop
