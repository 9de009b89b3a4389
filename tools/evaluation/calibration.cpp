// SPDX-License-Identifier: MIT
#include "evaluation/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seqloop::evaluation {
namespace {

double mean(double sum, std::uint64_t count) {
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

}  // namespace

double ReliabilityBin::mean_probability() const noexcept { return mean(probability_sum, count); }

double ReliabilityBin::share_right() const noexcept {
  return mean(static_cast<double>(right), count);
}

void add_answer(Reliability& reliability, double probability, bool right) noexcept {
  if (std::isnan(probability)) return;
  // As a float, of which there are nine digits in a match list: so .9 lies in the bin that begins
  // with it, whether it was read from one or not.
  const auto bin = static_cast<std::size_t>(static_cast<float>(probability) *
                                            static_cast<float>(reliability_bins));
  ReliabilityBin& into = reliability[std::min(bin, reliability_bins - 1)];
  ++into.count;
  into.right += right ? 1U : 0U;
  into.probability_sum += probability;
}

Reliability together(const Reliability& a, const Reliability& b) noexcept {
  Reliability sum = a;
  for (std::size_t bin = 0; bin < sum.size(); ++bin) {
    sum[bin].count += b[bin].count;
    sum[bin].right += b[bin].right;
    sum[bin].probability_sum += b[bin].probability_sum;
  }
  return sum;
}

double expected_calibration_error(const Reliability& reliability) noexcept {
  std::uint64_t answers = 0;
  double off = 0.0;
  for (const ReliabilityBin& bin : reliability) {
    answers += bin.count;
    off += std::abs(static_cast<double>(bin.right) - bin.probability_sum);
  }
  return mean(off, answers);
}

}  // namespace seqloop::evaluation
