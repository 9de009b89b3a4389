#pragma once

#include <cstddef>
#include <span>

#include "seqloop/arena.hpp"

namespace seqloop {

/// Mean and variance of every feature over a drive, one frame at a time, in fixed memory.
class RunningStatistics {
 public:
  /// Allocates: from the arena only, 16 bytes a feature.
  RunningStatistics(Arena& arena, std::size_t descriptor_size);

  /// Takes a frame in with the weight 1 / (frames so far + 1): exactly the mean and the variance of
  /// all frames.
  void observe(std::span<const float> descriptor) noexcept;

  /// The same with a weight of at least 1 / horizon: older frames fade.
  void observe(std::span<const float> descriptor, std::size_t horizon) noexcept;

  /// Starts from what another drive knows, as if that had been seen for `frames` frames (no more
  /// than it really was).
  void start_from(const RunningStatistics& other, std::size_t frames) noexcept;

  /// Subtracts the mean, divides by the deviation (a feature without deviation becomes 0), and
  /// divides the whole by its L2 norm.
  /// @param descriptor [D] read   @param out [>= D] written up to D; may be the same memory
  /// @return false when nothing deviates: then out is the zero vector
  /// Work: 3 D. Allocates: never.
  bool standardise(std::span<const float> descriptor, std::span<float> out) const noexcept;

  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }
  [[nodiscard]] std::span<const double> mean() const noexcept { return mean_; }
  [[nodiscard]] std::span<const double> variance() const noexcept { return variance_; }

 private:
  void observe_weighted(std::span<const float> descriptor, double weight) noexcept;

  std::size_t frames_ = 0;
  std::span<double> mean_;      // [D]
  std::span<double> variance_;  // [D], of the population
};

}  // namespace seqloop
