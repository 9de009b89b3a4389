// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "seqloop/difference.hpp"

// Dot products of floats in plain C++, in the order of `dot`.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// a * b + sum, rounded once, on every processor.
inline float add_product(float a, float b, float sum) noexcept {
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
  return __builtin_fmaf(a, b, sum);
#else
  // A product of floats is exact in double. So that rounding the sum to float is the only rounding
  // that counts, the double before is the odd one of the two that are next to the exact sum
  // (Boldo and Melquiond, Emulation of a FMA and correctly rounded sums, 2008); what the sum lacks
  // is exact, too (Knuth's two-sum).
  const double product = static_cast<double>(a) * static_cast<double>(b);
  const auto before = static_cast<double>(sum);
  const double rounded = product + before;
  const double added = rounded - product;
  const double lacks = (product - (rounded - added)) + (before - added);
  const auto bits = std::bit_cast<std::uint64_t>(rounded);
  const std::uint64_t even = ~bits & 1U;
  // Bits count up as numbers do on their way from zero. Where nothing is a number, neither is set.
  const double outwards = rounded < 0.0 ? -lacks : lacks;
  const std::uint64_t up = outwards > 0.0 ? even : 0U;
  const std::uint64_t down = outwards < 0.0 ? even : 0U;
  return static_cast<float>(std::bit_cast<double>(bits + up - down));
#endif
}

/// @param a, b [size], a whole number of dot_lanes
inline double lane_dot(const float* a, const float* b, std::size_t size) noexcept {
  double total = 0.0;
  for (std::size_t first = 0; first < size; first += float_block) {
    const std::size_t last = first + float_block < size ? first + float_block : size;
    float sums[dot_lanes] = {};
    for (std::size_t i = first; i < last; i += dot_lanes) {
      for (std::size_t lane = 0; lane < dot_lanes; ++lane) {
        sums[lane] = add_product(a[i + lane], b[i + lane], sums[lane]);
      }
    }
    total += static_cast<double>(((sums[0] + sums[2]) + (sums[1] + sums[3])) +
                                 ((sums[4] + sums[6]) + (sums[5] + sums[7])));
  }
  return total;
}

inline void lane_dots(const float* query, const float* rows, std::size_t stride, std::size_t count,
                      double* dots) noexcept {
  for (std::size_t row = 0; row < count; ++row) {
    dots[row] = lane_dot(query, rows + row * stride, stride);
  }
}

inline void lane_dots_block(const float* queries, std::size_t queries_count, const float* rows,
                            std::size_t stride, std::size_t count, double* dots,
                            std::size_t out_stride) noexcept {
  for (std::size_t query = 0; query < queries_count; ++query) {
    lane_dots(queries + query * stride, rows, stride, count, dots + query * out_stride);
  }
}

}  // namespace
}  // namespace seqloop::kernels
