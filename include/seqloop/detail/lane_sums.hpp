// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

namespace seqloop {

/// Sums that are kept side by side, so that the compiler may use registers of up to this many lanes
/// without changing what is added to what: the result is the same on every processor.
inline constexpr std::size_t sum_lanes = 8;

using LaneSums = std::array<double, sum_lanes>;

/// The sum of all, always in the same order.
[[nodiscard]] inline double total(const LaneSums& sums) noexcept {
  return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

/// Sums `term(i)` for i in [0, count), which is called once each, in order.
/// Work: count additions. Allocates: never.
template <class Term>
double sum_in_lanes(std::size_t count, Term term) noexcept {
  LaneSums sums{};
  const std::size_t whole = count / sum_lanes * sum_lanes;
  for (std::size_t i = 0; i < whole; i += sum_lanes) {
    for (std::size_t lane = 0; lane < sum_lanes; ++lane) sums[lane] += term(i + lane);
  }
  for (std::size_t i = whole; i < count; ++i) sums[i - whole] += term(i);
  return total(sums);
}

}  // namespace seqloop
