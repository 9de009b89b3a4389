// SPDX-License-Identifier: MIT
#include "seqloop/detail/calibration.hpp"

#include <algorithm>
#include <array>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

// Log-odds that a trace gives, and those of what was right. Linear between; equal behind the last.
using Points = std::array<double, 7>;
constexpr Points said{-4.6, -1.4, -0.3, 0.8, 2.2, 2.92, 2.944};
constexpr Points right{-1.25, -0.5, -0.42, 0.0, 0.6, 1.6, 2.944};
constexpr double slope_before = 0.31;

double between(const Points& from, const Points& to, double slope, double probability) {
  constexpr double tiny = 1e-12;
  const double sure = std::clamp(probability, tiny, 1.0 - tiny);
  const double odds = logarithm(sure / (1.0 - sure));
  if (odds >= from.back()) return probability;
  if (odds < from.front()) return logistic(to.front() + slope * (odds - from.front()));
  std::size_t next = 1;
  while (odds >= from[next]) ++next;
  const double share = (odds - from[next - 1]) / (from[next] - from[next - 1]);
  return logistic(to[next - 1] + share * (to[next] - to[next - 1]));
}

}  // namespace

double calibrated(double probability) noexcept {
  return between(said, right, slope_before, probability);
}

double before_calibration(double probability) noexcept {
  return between(right, said, 1.0 / slope_before, probability);
}

}  // namespace seqloop
