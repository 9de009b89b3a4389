#include "seqloop/detail/past_rivals.hpp"

#include <algorithm>

namespace seqloop {
namespace {

// How often the whole map goes by until most rivals have been seen.
constexpr std::size_t rounds = 4;

// A frame's two.
constexpr std::size_t rows_a_frame = 2;

/// Frames whose windows share half of theirs with the newest one's.
std::size_t frames_kept(const MatcherConfig& config) {
  return relocalises(config) ? config.sequence_length / 2 : 0;
}

}  // namespace

PastRivals::PastRivals(Arena& arena, const MatcherConfig& config)
    : slice_(config.relocalising.slice),
      seen_(arena.take<Seen>("past rivals", rows_a_frame * frames_kept(config))) {}

std::optional<double> PastRivals::lowest(std::size_t best, std::size_t half_window,
                                         std::size_t rows) const noexcept {
  const std::size_t other_slices = (std::max<std::size_t>(rows, 1) - 1) / slice_;
  const std::size_t frames = std::min(rounds * other_slices, seen_.size() / rows_a_frame);
  std::optional<double> lowest;
  const auto held = static_cast<std::size_t>(std::min<std::uint64_t>(remembered_, seen_.size()));
  for (const Seen& seen : seen_.first(held)) {
    const std::uint64_t age = now_ - seen.frame;
    if (age > frames) continue;
    // It may have moved a row a frame, or none, or two.
    const std::uint64_t row = seen.rival.row + age;
    const std::uint64_t near = half_window + age;
    if (row + near >= best && row <= best + near) continue;
    lowest = std::min(lowest.value_or(seen.rival.score), seen.rival.score);
  }
  return lowest;
}

void PastRivals::remember(Rival rival) noexcept {
  if (seen_.empty()) return;
  seen_[static_cast<std::size_t>(remembered_ % seen_.size())] = {now_, rival};
  ++remembered_;
}

void PastRivals::removed(std::size_t row) noexcept {
  for (Seen& seen : seen_) {
    if (seen.rival.row > row) --seen.rival.row;
  }
}

}  // namespace seqloop
