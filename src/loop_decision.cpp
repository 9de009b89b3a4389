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

/// Goes on with the rows of a run that were scored.
void look_at(std::span<const double> scores, CandidateRun run, Lowest& found) {
  for (std::size_t row = run.first; row < run.last; ++row) {
    if (scores[row] == no_score) continue;
    ++found.scored;
    if (scores[row] < found.score) {
      found.score = scores[row];
      found.row = row;
    }
  }
}

}  // namespace

std::optional<BestRow> LoopDecision::decide(const PlaceOrder& order, std::span<const double> scores,
                                            std::span<const CandidateRun> runs, bool keep_runner_up,
                                            std::span<const CandidateProposals::Proposal> proposals,
                                            std::size_t rows) noexcept {
  past_.next();
  Lowest best;
  for (const CandidateRun run : runs) look_at(scores, run, best);
  if (best.scored == 0) return std::nullopt;
  // Other sessions may know the same place: the row stands out within its own.
  const CandidateRun session = order.around(best.row);
  const std::size_t before = best.row - std::min(best.row, half_rwindow_);
  const std::size_t behind = best.row + half_rwindow_ + 1;
  Lowest runner_up;
  for (const CandidateRun run : runs) {
    look_at(scores, {std::max(run.first, session.first), std::min(run.last, before)}, runner_up);
    look_at(scores, {std::max(run.first, behind), std::min(run.last, session.last)}, runner_up);
  }
  for (const CandidateProposals::Proposal& proposal : proposals) {
    const std::size_t row = proposal.centre;
    const bool scored = std::ranges::any_of(
        runs, [&](CandidateRun run) { return run.first <= row && row < run.last; });
    const bool outside =
        session.first <= row && row < session.last && (row < before || behind <= row);
    if (scored || !outside) continue;
    ++runner_up.scored;
    if (proposal.difference >= runner_up.score) continue;
    runner_up.row = row;
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
