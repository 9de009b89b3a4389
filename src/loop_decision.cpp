#include "seqloop/detail/loop_decision.hpp"

#include <algorithm>
#include <limits>

namespace seqloop {
namespace {

constexpr double no_score = std::numeric_limits<double>::infinity();

struct Lowest {
  std::size_t row = 0;
  double score = no_score;
  std::size_t scored = 0;
};

/// The lowest score of the candidates that `counts` lets in.
template <class Counts>
Lowest lowest(std::span<const double> scores, std::span<const CandidateRun> runs, Counts counts) {
  Lowest found;
  for (const CandidateRun run : runs) {
    for (std::size_t row = run.first; row < run.last; ++row) {
      if (scores[row] == no_score || !counts(row)) continue;
      ++found.scored;
      if (scores[row] < found.score) found = {row, scores[row], found.scored};
    }
  }
  return found;
}

}  // namespace

std::optional<BestRow> LoopDecision::decide(std::span<const double> scores,
                                            std::span<const CandidateRun> runs, bool keep_rival,
                                            std::span<const PromisingRows::Promise> promises,
                                            std::size_t rows) noexcept {
  past_.next();
  const Lowest best = lowest(scores, runs, [](std::size_t) { return true; });
  if (best.scored == 0) return std::nullopt;
  const auto outside = [&](std::size_t row) {
    return row + half_window_ < best.row || row > best.row + half_window_;
  };
  Lowest rival = lowest(scores, runs, outside);
  for (const PromisingRows::Promise& promise : promises) {
    const bool scored = std::ranges::any_of(runs, [&](CandidateRun run) {
      return run.first <= promise.centre && promise.centre < run.last;
    });
    if (scored || !outside(promise.centre)) continue;
    ++rival.scored;
    if (promise.difference >= rival.score) continue;
    rival.row = promise.centre;
    rival.score = promise.difference;
  }
  const std::optional<double> past = past_.lowest(best.row, half_window_, rows);
  past_.remember({best.row, best.score});
  if (rival.scored > 0) past_.remember({rival.row, rival.score});
  if (past) rival = {rival.row, std::min(rival.score, *past), rival.scored + 1};
  const std::optional<double> rival_score =
      rival.scored > 0 ? std::optional(rival.score) : last_rival_;
  if (keep_rival) last_rival_ = rival_score;
  const double uniqueness =
      rival_score ? best.score / *rival_score : std::numeric_limits<double>::quiet_NaN();
  return BestRow{best.row, best.score, uniqueness, best.scored};
}

}  // namespace seqloop
