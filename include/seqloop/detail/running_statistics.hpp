// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "seqloop/detail/arena.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// What the buffers of some statistics are called in a plan.
struct StatisticsNames {
  std::string_view mean = "mean of each feature";
  std::string_view variance = "variance of each feature";
  std::string_view deviation = "deviation of each feature";
  std::string_view last_taken = "last frame that moved the statistics";
};

/// Mean and variance of every feature over a drive, one frame at a time, in fixed memory.
/// Source: src/README.md, section 5.1.
class RunningStatistics {
 public:
  /// Allocates: from the arena only, 24 bytes a feature.
  RunningStatistics(Arena& arena, std::size_t descriptor_size, const StatisticsNames& names = {});

  /// Takes a frame in with the weight 1 / (frames so far + 1): exactly the mean and the variance of
  /// all frames.
  void observe(std::span<const float> descriptor) noexcept;

  /// Moves on with a drive: the same with a weight of at least 1 / horizon, so that older frames
  /// fade. A frame that looks like the last one that was taken in is left out, so that a robot that
  /// stands still does not forget the drive. Of a drive that nothing is known of they are guessed
  /// from its first frame: every feature gets the mean of its own value and of that of all, as if
  /// one frame had shown it, and a quarter of the variance of all values, as if `prior_frames` had.
  void follow(std::span<const float> descriptor, const Standardisation& how) noexcept;

  /// Starts from what another drive knows, as if that had been seen for `frames` frames (no more
  /// than it really was).
  void start_from(const RunningStatistics& other, std::size_t frames) noexcept;

  /// Starts from what was saved of another drive.
  /// @param mean, variance [D]
  /// @return false when they are of another size, not finite, or a variance is below 0: then
  ///   nothing has changed
  [[nodiscard]] bool restore(std::span<const double> mean, std::span<const double> variance,
                             std::uint64_t frames) noexcept;

  /// Knows nothing any more: the next frame that is observed is the first.
  void forget() noexcept { frames_ = guessed_ = 0; }

  /// Subtracts the mean, divides by the deviation, and divides the whole by its L2 norm. What is
  /// divided by is no less than a tenth of the average deviation, nor than an eighth of the mean.
  /// @param descriptor [D] read   @param out [>= D] written up to D; may be the same memory
  /// @return false when nothing deviates (variances below 1e-45): then out is the zero vector
  /// Error: at most 3e-7 of a value, against a deviation and a quotient that are not rounded to
  /// float. Work: 4 D. Allocates: never.
  bool standardise(std::span<const float> descriptor, std::span<float> out) const noexcept;

  /// Of all features. Two frames that have nothing to do with each other are on average twice as
  /// far apart, squared.
  [[nodiscard]] double variance_sum() const noexcept { return variances_; }

  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }
  [[nodiscard]] std::span<const double> mean() const noexcept { return mean_; }
  [[nodiscard]] std::span<const double> variance() const noexcept { return variance_; }

 private:
  void guess(std::span<const float> descriptor, std::size_t frames) noexcept;
  void observe_weighted(std::span<const float> descriptor, double of_mean, double weight) noexcept;
  void sum_up() noexcept;

  std::size_t frames_ = 0;
  std::size_t guessed_ = 0;      // of these, which say nothing of the mean
  std::span<double> mean_;       // [D]
  std::span<double> variance_;   // [D], of the population
  std::span<float> deviation_;   // [D], its square root
  std::span<float> last_taken_;  // [D], the last frame that `follow` took in
  double variances_ = 0.0;       // sum of all
  double deviations_ = 0.0;      // sum of all
};

}  // namespace seqloop
