// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstring>

#include "kernels/blocks.hpp"
#include "kernels/float_squares.hpp"

// Many vectors by many, where there are 32 registers; where there are 16: float_tiles.hpp.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

void squares_block(const float* queries, std::size_t queries_count, const float* rows,
                   std::size_t stride, std::size_t count, double* sums, std::size_t out_stride,
                   float* /*room*/) noexcept {
  // As many sums as 32 registers have room for, besides the rows, a query and the difference.
  constexpr std::size_t abreast = 4;
  const std::size_t whole_queries = queries_count / abreast * abreast;
  const std::size_t whole_rows = count / rows_together * rows_together;
  for (std::size_t q = 0; q < whole_queries; ++q) {
    for (std::size_t r = 0; r < whole_rows; ++r) sums[q * out_stride + r] = 0.0;
  }
  for (std::size_t first = 0; first < stride; first += float_block) {
    const std::size_t length = stride - first < float_block ? stride - first : float_block;
    const std::size_t after = first + length < stride ? first + length : 0;
    // Some rows stay in the nearest cache while the queries pass by: copied, because vectors that
    // are a whole number of pages long share few places there.
    alignas(stored_line) float near[rows_together * float_block];
    for (std::size_t r = 0; r < whole_rows; r += rows_together) {
      for (std::size_t k = 0; k < rows_together; ++k) {
        std::memcpy(near + k * length, rows + (r + k) * stride + first, length * sizeof(float));
      }
      // What comes next is fetched in quarters: the next rows while queries pass by, the queries'
      // next values while rows do.
      const float* next = r + rows_together < whole_rows
                              ? rows + (r + rows_together) * stride + first
                              : rows + after;
      const std::size_t rows_done = r / rows_together;
      for (std::size_t q = 0; q < whole_queries; q += abreast) {
        const std::size_t queries_done = q / abreast;
        const float* next_row =
            next + queries_done / 4 % rows_together * stride + queries_done % 4 * (length / 4);
        const float* next_query = queries + (q + rows_done % abreast) * stride + after +
                                  rows_done / abreast % 4 * (length / 4);
        add_squares<abreast, rows_together>({queries + q * stride + first, stride, near, length,
                                             sums + q * out_stride + r, out_stride},
                                            length, [=](std::size_t i) {
                                              __builtin_prefetch(next_row + i / 4, 0, 2);
                                              __builtin_prefetch(next_query + i / 4, 0, 2);
                                            });
      }
    }
  }
  squares_behind_tiles(queries, queries_count, whole_queries, rows, stride, count, whole_rows, sums,
                       out_stride);
}

}  // namespace
}  // namespace seqloop::kernels
