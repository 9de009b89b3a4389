#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "seqloop/latency_histogram.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::program {

/// Counts a run, in fixed memory, for the words at its end.
class RunSummary {
 public:
  explicit RunSummary(Nanoseconds budget) : budget_(budget) {}

  /// @return whether the frame took longer than the budget
  bool add(const ProcessedFrame& processed);

  [[nodiscard]] std::uint64_t frames() const noexcept { return grab_.count(); }
  [[nodiscard]] std::uint64_t errors() const noexcept;

  /// Several lines.
  [[nodiscard]] std::string text() const;

 private:
  static constexpr std::size_t gates = 5;

  Nanoseconds budget_;
  std::array<std::uint64_t, gates> at_gate_{};
  std::uint64_t misses_ = 0;
  std::uint64_t map_full_ = 0;
  Nanoseconds latest_{0};
  LatencyHistogram grab_;
  LatencyHistogram describe_;
  LatencyHistogram match_;
  LatencyHistogram total_;
};

}  // namespace seqloop::program
