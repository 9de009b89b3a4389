// SPDX-License-Identifier: MIT
#include "seqloop/detail/candidate_budget.hpp"

#include <algorithm>
#include <limits>

#include "seqloop/detail/candidate_proposals.hpp"

namespace seqloop {
namespace {

constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

/// Ranges that a frame can have.
std::size_t most_runs(const MatcherConfig& config) {
  if (config.candidates == Candidates::all) return 1;
  const std::size_t k = config.candidates == Candidates::adaptive ? config.initial_k : config.k;
  // Of those that scan, also what the scan proposes and where the robot is believed to be.
  return k + (scans(config) ? CandidateProposals::most + 1 : 0);
}

/// Visits the cells that lines through the run can touch, the newest first, until one says false:
/// visit(frame, first row, last row).
template <class Visit>
bool for_each_column(const CandidateBudget::Window& window, CandidateRun run, Visit visit) {
  const Trajectories& lines = *window.trajectories;
  const CandidateRun session = window.map->order().around(run.first);
  const std::size_t end = std::min(window.rows, session.last);
  const auto first_row = static_cast<std::int64_t>(run.first);
  const auto last_row = static_cast<std::int64_t>(run.last);
  // In a window that is not full yet, the first frames are still missing.
  const auto frames =
      static_cast<std::size_t>(std::min<std::uint64_t>(lines.window(), window.end - window.first));
  for (std::size_t i = lines.window(); i-- > lines.window() - frames;) {
    const auto first =
        std::max(first_row + lines.lowest(i), static_cast<std::int64_t>(session.first));
    const auto last = std::min(last_row + lines.highest(i), static_cast<std::int64_t>(end));
    if (first >= last) continue;
    if (!visit(window.end + i - lines.window(), static_cast<std::size_t>(first),
               static_cast<std::size_t>(last))) {
      return false;
    }
  }
  return true;
}

}  // namespace

CandidateBudget::CandidateBudget(Arena& arena, const MatcherConfig& config)
    : limited_(relocalises(config)),
      most_rows_(limited_ ? most_rows(config) : any),
      most_distances_(limited_ ? distances_a_frame(config) : any),
      runs_(arena, most_runs(config)) {}

void CandidateBudget::clear() noexcept {
  runs_.clear();
  rows_ = 0;
  distances_ = 0;
}

void CandidateBudget::add(const Window& window, CandidateRun range) noexcept {
  window.map->order().in_sessions(range, [&](CandidateRun part) { add_part(window, part); });
}

void CandidateBudget::add_part(const Window& window, CandidateRun range) noexcept {
  if (rows_ == most_rows_) return;
  // With nothing left to spend, only what is there already can come in.
  if (distances_ == most_distances_ && !complete(window, range)) return;
  for (;;) {
    const Cost more = limited_ ? cost(window, range) : Cost{1, 0, 0};
    if (more.rows == 0) return;
    const bool fits =
        rows_ + more.rows <= most_rows_ && distances_ + more.distances <= most_distances_;
    const std::size_t length = range.last - range.first;
    if (fits || length == 1) {
      compute(window, range, window.slices->enhanced() ? 0 : more.oldest, fits);
      if (!fits) return;
      rows_ += more.rows;
      runs_.add(range);
      return;
    }
    // About as many rows around the middle as can be afforded, at least one fewer.
    const std::size_t left = std::min(most_distances_ - distances_, more.distances);
    const std::size_t share = more.distances == 0 ? length : length * left / more.distances;
    const std::size_t rows = std::min({share, most_rows_ - rows_, length - 1});
    const std::size_t half = (std::max<std::size_t>(rows, 1) - 1) / 2;
    const std::size_t middle = range.first + length / 2;
    range = {middle - half, middle + half + 1};
  }
}

CandidateBudget::Cost CandidateBudget::cost(const Window& window,
                                            CandidateRun range) const noexcept {
  Cost sum;
  runs_.for_each_outside(range, [&](CandidateRun part) {
    sum.rows += part.last - part.first;
    for_each_column(window, part, [&](std::uint64_t frame, std::size_t first, std::size_t last) {
      const std::size_t missing = window.slices->missing(*window.map, frame, first, last);
      sum.distances += missing;
      if (missing > 0) sum.oldest = std::min(sum.oldest, frame);
      return true;
    });
  });
  return sum;
}

bool CandidateBudget::complete(const Window& window, CandidateRun range) const noexcept {
  bool complete = true;
  runs_.for_each_outside(range, [&](CandidateRun part) {
    complete = complete &&
               for_each_column(
                   window, part, [&](std::uint64_t frame, std::size_t first, std::size_t last) {
                     return window.slices->missing(*window.map, frame, first, last) == 0;
                   });
  });
  return complete;
}

void CandidateBudget::compute(const Window& window, CandidateRun range, std::uint64_t oldest,
                              bool fits) noexcept {
  runs_.for_each_outside(range, [&](CandidateRun part) {
    for_each_column(window, part, [&](std::uint64_t frame, std::size_t first, std::size_t last) {
      if (frame < oldest) return false;
      // A column is computed whole, or left to the next frames.
      const std::size_t left = most_distances_ - distances_;
      if (!fits && window.slices->missing(*window.map, frame, first, last) > left) return false;
      distances_ += window.slices->fill(*window.map, frame, first, last);
      return true;
    });
  });
}

}  // namespace seqloop
