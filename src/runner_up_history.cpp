// SPDX-License-Identifier: MIT
#include "seqloop/detail/runner_up_history.hpp"

#include <algorithm>

#include "seqloop/detail/kept_row.hpp"

namespace seqloop {
namespace {

// How often the whole map goes by until most runners-up have been seen.
constexpr std::size_t rounds = 4;

// A frame's two.
constexpr std::size_t rows_a_frame = 2;

/// Frames whose windows share half of theirs with the newest one's.
std::size_t frames_kept(const MatcherConfig& config) {
  return relocalises(config) ? config.sequence_length / 2 : 0;
}

}  // namespace

RunnerUpHistory::RunnerUpHistory(Arena& arena, const MatcherConfig& config)
    : rows_a_scan_(config.relocalising.rows_scanned),
      seen_(arena.take<Seen>("runners-up of the last frames", rows_a_frame * frames_kept(config))) {
}

std::optional<double> RunnerUpHistory::lowest(std::size_t best, std::size_t half_rwindow,
                                              std::size_t rows, CandidateRun among) const noexcept {
  if (seen_.empty()) return std::nullopt;
  const std::size_t other_scans = (std::max<std::size_t>(rows, 1) - 1) / rows_a_scan_;
  const std::size_t frames = std::min(rounds * other_scans, seen_.size() / rows_a_frame);
  std::optional<double> lowest;
  const auto held = static_cast<std::size_t>(std::min<std::uint64_t>(remembered_, seen_.size()));
  for (const Seen& seen : seen_.first(held)) {
    const std::uint64_t age = now_ - seen.frame;
    if (age > frames || seen.row.row < among.first || seen.row.row >= among.last) continue;
    // It may have moved a row a frame, or none, or two.
    const std::uint64_t row = seen.row.row + age;
    const std::uint64_t near = half_rwindow + age;
    if (row + near >= best && row <= best + near) continue;
    lowest = std::min(lowest.value_or(seen.row.score), seen.row.score);
  }
  return lowest;
}

void RunnerUpHistory::remember(RunnerUp row) noexcept {
  if (seen_.empty()) return;
  seen_[static_cast<std::size_t>(remembered_ % seen_.size())] = {now_, row};
  ++remembered_;
}

void RunnerUpHistory::removed(std::size_t row) noexcept {
  for (Seen& seen : seen_) {
    count_without(row, false, seen.row.row);
  }
}

void RunnerUpHistory::inserted(std::size_t row) noexcept {
  for (Seen& seen : seen_) {
    count_with(row, seen.row.row);
  }
}

}  // namespace seqloop
