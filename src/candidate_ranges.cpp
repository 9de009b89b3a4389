#include "seqloop/candidate_ranges.hpp"

#include <algorithm>
#include <limits>

namespace seqloop {
namespace {

// Algorithm 5: the scene counts as steady between these change degrees, and K follows the largest
// of so many steady frames' needs.
constexpr double steady_from = 0.9;
constexpr double steady_to = 1.1;
constexpr std::size_t frames_to_record = 10;

std::size_t starting_k(const MatcherConfig& config) {
  switch (config.candidates) {
    case Candidates::all:
      return 0;
    case Candidates::ranges:
      return config.k;
    case Candidates::adaptive:
      return config.initial_k;
  }
  return 0;
}

std::size_t distance(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }

}  // namespace

CandidateRanges::CandidateRanges(Arena& arena, const MatcherConfig& config)
    : kind_(config.candidates),
      half_range_(config.num / 2),
      reinit_(config.reinit),
      initial_k_(config.initial_k),
      k_(starting_k(config)),
      ranked_(arena.take<ScoredRow>("ranked candidates", k_)),
      runs_(arena.take<CandidateRun>("candidate runs", std::max<std::size_t>(k_, 1))) {}

std::span<const CandidateRun> CandidateRanges::choose(std::size_t rows) noexcept {
  full_search_ =
      kind_ == Candidates::all || ranked_count_ == 0 || rows == 0 || matched_frames_ % reinit_ == 0;
  run_count_ = 0;
  if (full_search_) {
    if (rows > 0) runs_[run_count_++] = {0, rows};
    return runs_.first(run_count_);
  }
  // Algorithm 4: [T(k) - Num/2, T(k) + Num/2] for k = 1 .. K, clipped to the map, united.
  const std::size_t ranges = std::min(k_, ranked_count_);
  for (std::size_t i = 0; i < ranges; ++i) {
    const std::size_t row = std::min(ranked_[i].row, rows - 1);
    runs_[i] = {row - std::min(row, half_range_), std::min(row + half_range_ + 1, rows)};
  }
  std::ranges::sort(runs_.first(ranges), {}, &CandidateRun::first);
  for (const CandidateRun range : runs_.first(ranges)) {
    if (run_count_ > 0 && range.first <= runs_[run_count_ - 1].last) {
      runs_[run_count_ - 1].last = std::max(runs_[run_count_ - 1].last, range.last);
    } else {
      runs_[run_count_++] = range;
    }
  }
  return runs_.first(run_count_);
}

void CandidateRanges::update(std::span<const float> scores, std::optional<std::size_t> match,
                             double change_degree) noexcept {
  if (kind_ == Candidates::all) return;
  if (!match) {
    ranked_count_ = 0;
    return;
  }
  if (kind_ == Candidates::adaptive && !full_search_) adapt_k(*match, change_degree);
  rank(scores);
  ++matched_frames_;
}

void CandidateRanges::skip(std::uint64_t frames) noexcept {
  for (ScoredRow& ranked : ranked_.first(ranked_count_)) {
    ranked.row += static_cast<std::size_t>(frames);
  }
}

void CandidateRanges::restart() noexcept {
  ranked_count_ = 0;
  recorded_ = 0;
  recorded_maximum_ = 0;
  if (kind_ == Candidates::adaptive) k_ = initial_k_;
}

void CandidateRanges::adapt_k(std::size_t match, double change_degree) noexcept {
  if (change_degree < steady_from || change_degree > steady_to) {
    k_ = initial_k_;
    recorded_ = 0;
    recorded_maximum_ = 0;
    return;
  }
  // IML: how far down the list that made this frame's candidates the match was (D6).
  std::size_t needed = 1;
  while (needed < std::min(k_, ranked_count_) &&
         distance(match, ranked_[needed - 1].row) > half_range_) {
    ++needed;
  }
  recorded_maximum_ = std::max(recorded_maximum_, needed);
  if (++recorded_ < frames_to_record) return;
  k_ = recorded_maximum_;
  recorded_ = 0;
  recorded_maximum_ = 0;
}

void CandidateRanges::rank(std::span<const float> scores) noexcept {
  ranked_count_ = 0;
  const auto last_score = [&] { return ranked_[ranked_count_ - 1].score; };
  for (const CandidateRun run : runs_.first(run_count_)) {
    for (std::size_t row = run.first; row < run.last; ++row) {
      const float score = scores[row];
      if (!(score < std::numeric_limits<float>::infinity())) continue;
      const bool full = ranked_count_ == ranked_.size();
      if (full && score >= last_score()) continue;
      // Rows come in rising order, so going behind equal scores keeps the lower row first.
      std::size_t place = full ? ranked_count_ - 1 : ranked_count_++;
      for (; place > 0 && ranked_[place - 1].score > score; --place) {
        ranked_[place] = ranked_[place - 1];
      }
      ranked_[place] = {score, row};
    }
  }
}

}  // namespace seqloop
