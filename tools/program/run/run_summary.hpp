// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "program/run/frame_json.hpp"
#include "seqloop/latency_histogram.hpp"
#include "seqloop/linux/live_source.hpp"

namespace seqloop::program {

/// A stage of the loop, and how long it took.
struct StageRecord {
  const char* name;
  LatencyHistogram times;
};

/// Counts a run, in fixed memory, for the words and the report at its end.
class RunSummary {
 public:
  /// @param live whether frames have an age and can be dropped
  RunSummary(const Budget& budget, bool live) : budget_(budget), live_(live) {}

  void add(const ProcessedFrame& processed, const LoopState& state);

  /// Answers that were due at the end.
  void add(std::span<const Answer> answers);

  /// What became of a live source's frames.
  void captured(const live::LiveCounts& counts) {
    capture_ = counts;
    dropped_ = counts.dropped;
    lost_ = counts.lost;
  }
  [[nodiscard]] const std::optional<live::LiveCounts>& capture() const noexcept { return capture_; }

  /// Frames that were taken up, those that could not be read included.
  [[nodiscard]] std::uint64_t frames() const noexcept { return stages_[total].times.count(); }
  /// Frames by their final answer; of `warming_up`, those that have none. Of `no_frame`, events.
  [[nodiscard]] std::uint64_t at(Gate gate) const noexcept;
  [[nodiscard]] std::uint64_t misses() const noexcept { return misses_; }
  /// Frames that broke each limit, by the names of `Misses`.
  [[nodiscard]] const std::map<std::string_view, std::uint64_t>& missed() const noexcept {
    return missed_;
  }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
  [[nodiscard]] std::uint64_t overloaded() const noexcept { return overloaded_; }

  /// grab, describe, match, total; of a live source also age and answer, which is age and total.
  [[nodiscard]] std::span<const StageRecord> stages() const noexcept {
    return std::span(stages_).first(live_ ? stages_.size() : age);
  }

  /// Several lines.
  [[nodiscard]] std::string text() const;

 private:
  enum Stage : std::size_t { grab, describe, match, total, age, answer };

  Budget budget_;
  bool live_;
  std::array<std::uint64_t, gates> at_gate_{};
  std::uint64_t misses_ = 0;
  std::map<std::string_view, std::uint64_t> missed_{
      {"age", 0}, {"describe", 0}, {"grab", 0}, {"match", 0}, {"total", 0}};
  std::uint64_t dropped_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t overloaded_ = 0;
  std::uint64_t map_full_ = 0;
  std::optional<live::LiveCounts> capture_;
  std::array<StageRecord, 6> stages_{
      {{"grab", {}}, {"describe", {}}, {"match", {}}, {"total", {}}, {"age", {}}, {"answer", {}}}};
};

}  // namespace seqloop::program
