// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "seqloop/clock.hpp"

namespace seqloop {

/// Durations in fixed memory: buckets that are at most 1/32 wide, from 1 ns to 2^63 ns.
class LatencyHistogram {
  static constexpr unsigned steps_bits = 5;
  static constexpr std::size_t steps = std::size_t{1} << steps_bits;

 public:
  /// Negative durations count as zero. Work: constant. Allocates: never.
  void add(Nanoseconds duration) noexcept;

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] Nanoseconds maximum() const noexcept { return maximum_; }

  /// @param share 0 .. 1, such as 0.99; beyond counts as the nearer of these, NaN as 0
  /// @return a duration that at least this share of all does not exceed, up to 1/32 too high, never
  ///   above the maximum; zero when nothing was added
  [[nodiscard]] Nanoseconds quantile(double share) const noexcept;

  /// Buckets follow each other without a gap.
  static constexpr std::size_t buckets = (64 - steps_bits) * steps;

  /// @param bucket below `buckets`
  [[nodiscard]] std::uint64_t count_in(std::size_t bucket) const noexcept {
    return buckets_[bucket];
  }

  /// @param bucket below `buckets`
  /// @return the longest duration that falls into it
  [[nodiscard]] static Nanoseconds longest_in(std::size_t bucket) noexcept;

 private:
  std::array<std::uint64_t, buckets> buckets_{};
  std::uint64_t count_ = 0;
  Nanoseconds maximum_{0};
};

}  // namespace seqloop
