// SPDX-License-Identifier: MIT
#include "seqloop/detail/calibration.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

// Log-odds that are given, and those of what was right. Linear between, and before the first with a
// slope of its own; equal behind the last.
template <std::size_t count>
using Points = std::array<double, count>;

// Of answers, by what their trace gives.
constexpr Points<9> said{-13.0, -9.0, -4.6, -1.4, -0.3, 0.8, 2.2, 2.92, 2.944};
constexpr Points<9> right{-4.3, -3.3, -2.1, -1.5, -1.25, 0.0, 0.9, 1.6, 2.944};
constexpr double slope_before = 0.2;

// Of the newest frame.
constexpr Points<7> said_now{-14.0, -9.0, -6.0, -3.5, -1.75, 0.5, 2.2};
constexpr Points<7> right_now{-2.6, -2.1, -1.4, -0.65, 0.25, 1.2, 2.2};
constexpr double slope_before_now = 0.3;

/// @param odds less than the last of `from`
template <std::size_t count>
double between(const Points<count>& from, const Points<count>& to, double slope, double odds) {
  if (odds < from.front()) return logistic(to.front() + slope * (odds - from.front()));
  std::size_t next = 1;
  while (odds >= from[next]) ++next;
  const double share = (odds - from[next - 1]) / (from[next] - from[next - 1]);
  return logistic(to[next - 1] + share * (to[next] - to[next - 1]));
}

/// The same of a probability; itself from the last on.
template <std::size_t count>
double mapped(const Points<count>& from, const Points<count>& to, double slope,
              double probability) {
  constexpr double tiny = 1e-12;
  const double sure = std::clamp(probability, tiny, 1.0 - tiny);
  const double odds = logarithm(sure / (1.0 - sure));
  return odds < from.back() ? between(from, to, slope, odds) : probability;
}

}  // namespace

double calibrated(double probability) noexcept {
  return mapped(said, right, slope_before, probability);
}

double before_calibration(double probability) noexcept {
  return mapped(right, said, 1.0 / slope_before, probability);
}

double calibrated_now(double odds) noexcept {
  return odds < said_now.back() ? between(said_now, right_now, slope_before_now, odds)
                                : logistic(odds);
}

}  // namespace seqloop
