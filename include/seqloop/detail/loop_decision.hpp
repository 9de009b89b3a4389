// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_proposals.hpp"
#include "seqloop/detail/candidate_runs.hpp"
#include "seqloop/detail/place_order.hpp"
#include "seqloop/detail/runner_up_history.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// The best row among a frame's candidates and how far it stands out.
struct BestRow {
  std::size_t row;
  double score;        ///< infinity never comes here
  double uniqueness;   ///< score by the best score outside the row's window, in its session; NaN
                       ///< where not defined
  std::size_t scored;  ///< candidates that had a score
  /// The row of that best score elsewhere; none where an earlier frame's stood in for it.
  std::optional<std::size_t> runner_up;
};

/// Picks the best row and says how unique it is. Source: src/README.md,
/// sections 3.5 and 4.4.
class LoopDecision {
 public:
  /// Allocates: from the arena only.
  LoopDecision(Arena& arena, const MatcherConfig& config)
      : half_rwindow_(config.rwindow / 2), past_(arena, config) {}

  /// @param scores [places], infinity for a row that no line fits
  /// @param keep_runner_up whether this frame's runner-up stands in later, at frames whose
  /// candidates have none (src/README.md, section 4.4): after a full search
  /// @param proposals rows that could not all be afforded: those that have no score may be the
  /// runner-up by what their sketches tell
  /// @param rows rows of the map that may be searched
  /// @return the row with the lowest score, the lower row of equals; none when no row has a score
  /// Work: two passes over the candidates, one over `RunnerUpHistory`. Allocates: never.
  [[nodiscard]] std::optional<BestRow> decide(
      const PlaceOrder& order, std::span<const double> scores, std::span<const CandidateRun> runs,
      bool keep_runner_up, std::span<const CandidateProposals::Proposal> proposals,
      std::size_t rows) noexcept;

  /// Frames went by unseen.
  void skip(std::uint64_t frames) noexcept { past_.skip(frames); }

  /// A row went from the map: those behind it are counted one lower.
  void removed(std::size_t row) noexcept { past_.removed(row); }

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept { past_.inserted(row); }

  /// Forgets what the frames before saw, but for the runner-up that stands in later.
  void restart() noexcept { past_.restart(); }

 private:
  std::size_t half_rwindow_;
  RunnerUpHistory past_;
  std::optional<double> last_runner_up_;
};

}  // namespace seqloop
