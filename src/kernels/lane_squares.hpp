// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "seqloop/difference.hpp"

// Sums over the differences of two vectors in plain C++, in the order of `euclidean`.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// value * value + sum, rounded once, on every processor.
/// @param sum at least 0
inline float add_square(float value, float sum) noexcept {
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
  return __builtin_fmaf(value, value, sum);
#else
  // A product of floats is exact in double. So that rounding the sum to float is the only rounding
  // that counts, the double before is the odd one of the two that are next to the exact sum
  // (Boldo and Melquiond, Emulation of a FMA and correctly rounded sums, 2008); what the sum lacks
  // is exact, too (Knuth's two-sum).
  const double square = static_cast<double>(value) * static_cast<double>(value);
  const auto before = static_cast<double>(sum);
  const double rounded = square + before;
  const double added = rounded - square;
  const double lacks = (square - (rounded - added)) + (before - added);
  const auto bits = std::bit_cast<std::uint64_t>(rounded);
  const std::uint64_t even = ~bits & 1U;
  // Nothing is negative, so that bits count up as numbers do. Where nothing is a number, neither.
  const std::uint64_t up = lacks > 0.0 ? even : 0U;
  const std::uint64_t down = lacks < 0.0 ? even : 0U;
  return static_cast<float>(std::bit_cast<double>(bits + up - down));
#endif
}

/// @param a, b [size], a whole number of lanes
/// @param add  `add(a[i] - b[i], sum)`: the sum with a term of the difference
template <class Add>
double sum_of_differences(const float* a, const float* b, std::size_t size, Add add) noexcept {
  // Partial sums move to double before float has lost digits on long descriptors.
  double sum = 0.0;
  for (std::size_t first = 0; first < size; first += float_block) {
    const std::size_t last = first + float_block < size ? first + float_block : size;
    float partial[lanes] = {};
    for (std::size_t i = first; i < last; i += lanes) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        partial[lane] = add(a[i + lane] - b[i + lane], partial[lane]);
      }
    }
    for (std::size_t lane = 0; lane < lanes; lane += 4) {
      sum += static_cast<double>((partial[lane] + partial[lane + 2]) +
                                 (partial[lane + 1] + partial[lane + 3]));
    }
  }
  return sum;
}

inline double sum_of_squares(const float* a, const float* b, std::size_t size) noexcept {
  return sum_of_differences(a, b, size, add_square);
}

inline void lane_squares(const float* query, const float* rows, std::size_t stride,
                         std::size_t count, double* sums) noexcept {
  for (std::size_t row = 0; row < count; ++row) {
    sums[row] = sum_of_squares(query, rows + row * stride, stride);
  }
}

inline void lane_squares_block(const float* queries, std::size_t queries_count, const float* rows,
                               std::size_t stride, std::size_t count, double* sums,
                               std::size_t out_stride, float* /*room*/) noexcept {
  for (std::size_t query = 0; query < queries_count; ++query) {
    lane_squares(queries + query * stride, rows, stride, count, sums + query * out_stride);
  }
}

}  // namespace
}  // namespace seqloop::kernels
