// SPDX-License-Identifier: MIT
#include "seqloop/detail/calibration.hpp"

#include <algorithm>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

// Log-odds that a trace gives, and those of what was right: a line up to the first of these, one
// that is steeper to the second, and behind that they are equal.
constexpr double doubtful = 2.6;
constexpr double trusted = 3.7;
constexpr double slope = 0.34;
constexpr double of_doubtful = 0.6 + slope * doubtful;
constexpr double steep = (trusted - of_doubtful) / (trusted - doubtful);

double log_odds(double probability) {
  constexpr double tiny = 1e-12;
  const double sure = std::clamp(probability, tiny, 1.0 - tiny);
  return logarithm(sure / (1.0 - sure));
}

}  // namespace

double calibrated(double probability) noexcept {
  const double odds = log_odds(probability);
  if (odds >= trusted) return probability;
  return logistic(of_doubtful + (odds < doubtful ? slope : steep) * (odds - doubtful));
}

double before_calibration(double probability) noexcept {
  const double odds = log_odds(probability);
  if (odds >= trusted) return probability;
  return logistic(doubtful + (odds - of_doubtful) / (odds < of_doubtful ? slope : steep));
}

}  // namespace seqloop
