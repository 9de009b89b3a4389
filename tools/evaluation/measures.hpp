// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "evaluation/calibration.hpp"
#include "evaluation/match_list.hpp"
#include "evaluation/truth.hpp"

namespace seqloop::evaluation {

struct CurvePoint {
  double recall;
  double precision;
};

struct Measures {
  std::uint64_t answered = 0;
  std::uint64_t correct = 0;
  double precision = 0.0;                ///< of all answers, Eq. (2); 0 without answers
  double recall = 0.0;                   ///< of all answers, Eq. (3)
  double recall_at_100_precision = 0.0;  ///< the highest recall at which nothing is wrong
  /// Area under precision over recall by the trapezoid rule; down to recall 0 the first point's
  /// precision counts, beyond the last point's recall nothing does.
  double area_under_curve = 0.0;
  std::vector<CurvePoint> curve;  ///< rising recall; equal thresholds enter together

  std::uint64_t unknown = 0;  ///< answers that the truth cannot judge; nothing else counts them
  std::optional<std::uint64_t> accepted;  ///< answers; none where one does not say
  double accepted_precision = std::numeric_limits<double>::quiet_NaN();  ///< NaN: none is accepted
  double accepted_recall = std::numeric_limits<double>::quiet_NaN();  ///< NaN: no query has a truth
  Reliability reliability{};  ///< of all answers that have a probability, accepted or not
};

/// @param tolerance frames by which a match may be off, Eqs. (2), (3)
/// @param frames    queries that have a truth, what recall is a share of; 0: recall is 0
[[nodiscard]] Measures measure(std::vector<Answer> answers, const Truth& truth,
                               std::uint64_t tolerance, std::uint64_t frames);

}  // namespace seqloop::evaluation
