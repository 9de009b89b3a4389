// SPDX-License-Identifier: MIT
#include "seqloop/detail/candidate_ranges.hpp"

#include <algorithm>
#include <limits>

#include "seqloop/detail/keep_lowest.hpp"
#include "seqloop/detail/kept_row.hpp"

namespace seqloop {
namespace {

// Algorithm 5: the scene counts as steady between these change degrees, and K follows the largest
// of this many steady frames' needs.
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
      searches_all_(!relocalises(config)),
      half_range_(config.num / 2),
      reinit_(config.reinit),
      initial_k_(config.initial_k),
      k_(starting_k(config)),
      ranked_(arena.take<ScoredRow>("ranked candidates", k_)),
      ranges_(arena.take<CandidateRun>("candidate ranges", std::max<std::size_t>(k_, 1))) {}

std::span<const CandidateRun> CandidateRanges::choose(const PlaceOrder& order,
                                                      std::size_t rows) noexcept {
  full_search_ = searches_all_ && (kind_ == Candidates::all || ranked_count_ == 0 || rows == 0 ||
                                   matched_frames_ % reinit_ == 0);
  if (rows == 0) return {};
  if (full_search_) {
    ranges_[0] = {0, rows};
    return ranges_.first(1);
  }
  // Algorithm 4: [T(k) - Num/2, T(k) + Num/2] for k = 1 .. K, clipped to the map, and to the
  // session.
  const std::size_t count = std::min(k_, ranked_count_);
  for (std::size_t i = 0; i < count; ++i) ranges_[i] = around(order, ranked_[i].row, rows);
  return ranges_.first(count);
}

CandidateRun CandidateRanges::around(const PlaceOrder& order, std::size_t row,
                                     std::size_t rows) const noexcept {
  row = std::min(row, rows - 1);
  const CandidateRun session = order.around(row);
  return {order.before(row, half_range_), std::min({row + half_range_ + 1, rows, session.last})};
}

void CandidateRanges::update(std::span<const double> scores, std::span<const CandidateRun> runs,
                             std::optional<std::size_t> match, double change_degree) noexcept {
  if (kind_ == Candidates::all) return;
  if (!match) {
    ranked_count_ = 0;
    return;
  }
  if (kind_ == Candidates::adaptive && !full_search_) adapt_k(*match, change_degree);
  rank(scores, runs);
  ++matched_frames_;
}

void CandidateRanges::skip(const PlaceOrder& order, std::uint64_t frames) noexcept {
  const auto by = static_cast<std::size_t>(frames);
  for (ScoredRow& ranked : ranked_.first(ranked_count_)) {
    // At its session's end it stays.
    const bool ends = order.apart(ranked.row, ranked.row + by) != by;
    ranked.row = ends ? order.around(ranked.row).last - 1 : ranked.row + by;
  }
}

void CandidateRanges::restart() noexcept {
  ranked_count_ = 0;
  recorded_ = 0;
  recorded_maximum_ = 0;
  if (kind_ == Candidates::adaptive) k_ = initial_k_;
}

void CandidateRanges::removed(std::size_t row) noexcept {
  for (ScoredRow& ranked : ranked_.first(ranked_count_)) {
    count_without(row, false, ranked.row);
  }
}

void CandidateRanges::inserted(std::size_t row) noexcept {
  for (ScoredRow& ranked : ranked_.first(ranked_count_)) {
    count_with(row, ranked.row);
  }
}

void CandidateRanges::adapt_k(std::size_t match, double change_degree) noexcept {
  if (change_degree < steady_from || change_degree > steady_to) {
    k_ = initial_k_;
    recorded_ = 0;
    recorded_maximum_ = 0;
    return;
  }
  // IML: how far down the list that made this frame's candidates the match was (src/README.md,
  // section 4.6).
  if (ranked_count_ == 0) return;
  std::size_t needed = 1;
  while (needed < std::min(k_, ranked_count_) &&
         distance(match, ranked_[needed - 1].row) > half_range_) {
    ++needed;
  }
  // A match that relocalising found was in none of the ranges: as when the scene changes.
  if (distance(match, ranked_[needed - 1].row) > half_range_) needed = initial_k_;
  recorded_maximum_ = std::max(recorded_maximum_, needed);
  if (++recorded_ < frames_to_record) return;
  k_ = recorded_maximum_;
  recorded_ = 0;
  recorded_maximum_ = 0;
}

void CandidateRanges::rank(std::span<const double> scores,
                           std::span<const CandidateRun> runs) noexcept {
  ranked_count_ = 0;
  for (const CandidateRun run : runs) {
    for (std::size_t row = run.first; row < run.last; ++row) {
      const double score = scores[row];
      if (!(score < std::numeric_limits<double>::infinity())) continue;
      // Rows come in rising order, so going behind equal scores keeps the lower row first.
      ranked_count_ = keep_lowest(ranked_, ranked_count_, {score, row}, &ScoredRow::score);
    }
  }
}

}  // namespace seqloop
