// SPDX-License-Identifier: MIT
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

std::optional<BestRow> LoopDecision::decide(const PlaceOrder& order, std::span<const double> scores,
                                            std::span<const CandidateRun> runs, bool keep_runner_up,
                                            std::span<const CandidateProposals::Proposal> proposals,
                                            std::size_t rows) noexcept {
  past_.next();
  const Lowest best = lowest(scores, runs, [](std::size_t) { return true; });
  if (best.scored == 0) return std::nullopt;
  // Other sessions may know the same place: the row stands out within its own.
  const CandidateRun session = order.around(best.row);
  const auto outside = [&](std::size_t row) {
    return (row + half_rwindow_ < best.row || row > best.row + half_rwindow_) &&
           session.first <= row && row < session.last;
  };
  Lowest runner_up = lowest(scores, runs, outside);
  for (const CandidateProposals::Proposal& proposal : proposals) {
    const bool scored = std::ranges::any_of(runs, [&](CandidateRun run) {
      return run.first <= proposal.centre && proposal.centre < run.last;
    });
    if (scored || !outside(proposal.centre)) continue;
    ++runner_up.scored;
    if (proposal.difference >= runner_up.score) continue;
    runner_up.row = proposal.centre;
    runner_up.score = proposal.difference;
  }
  const std::optional<double> past = past_.lowest(best.row, half_rwindow_, rows, session);
  past_.remember({best.row, best.score});
  if (runner_up.scored > 0) past_.remember({runner_up.row, runner_up.score});
  const bool is_of_this_frame = runner_up.scored > 0 && !(past && *past < runner_up.score);
  const auto seen_now = is_of_this_frame ? std::optional(runner_up.row) : std::nullopt;
  if (past) runner_up = {runner_up.row, std::min(runner_up.score, *past), runner_up.scored + 1};
  const std::optional<double> runner_up_score =
      runner_up.scored > 0 ? std::optional(runner_up.score) : last_runner_up_;
  if (keep_runner_up) last_runner_up_ = runner_up_score;
  const double uniqueness =
      runner_up_score ? best.score / *runner_up_score : std::numeric_limits<double>::quiet_NaN();
  return BestRow{best.row, best.score, uniqueness, best.scored, seen_now};
}

}  // namespace seqloop
