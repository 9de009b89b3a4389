// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace seqloop::evaluation {

/// Answers that were said with about the same probability.
struct ReliabilityBin {
  std::uint64_t count = 0;
  std::uint64_t right = 0;
  double probability_sum = 0.0;

  [[nodiscard]] double mean_probability() const noexcept;  ///< NaN without answers
  [[nodiscard]] double share_right() const noexcept;       ///< NaN without answers
};

inline constexpr std::size_t reliability_bins = 10;

/// Bin i holds the answers with i / 10 <= probability < (i + 1) / 10, the last one 1 as well.
using Reliability = std::array<ReliabilityBin, reliability_bins>;

/// Counts an answer.
/// @param probability 0 .. 1; an answer with NaN says nothing of itself and is left out
void add_answer(Reliability& reliability, double probability, bool right) noexcept;

/// Both counted as one.
[[nodiscard]] Reliability together(const Reliability& a, const Reliability& b) noexcept;

/// How far probabilities are off: |share right - mean probability| of each bin, weighed by the
/// share of the answers that it holds. 0 is perfect, 1 the worst; NaN without answers.
/// Source: Naeini, Cooper, Hauskrecht, Obtaining Well Calibrated Probabilities Using Bayesian
/// Binning, AAAI 2015.
[[nodiscard]] double expected_calibration_error(const Reliability& reliability) noexcept;

}  // namespace seqloop::evaluation
