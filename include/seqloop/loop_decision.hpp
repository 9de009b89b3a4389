#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "seqloop/candidate_runs.hpp"
#include "seqloop/promising_rows.hpp"

namespace seqloop {

/// The best row among a frame's candidates and how far it stands out.
struct BestRow {
  std::size_t row;
  double score;        ///< infinity never comes here
  double uniqueness;   ///< score by the best score outside the row's window; NaN where not defined
  std::size_t scored;  ///< candidates that had a score
};

/// Picks the best row and says how unique it is. Source: ALGORITHMS, match and confidence; D4.
class LoopDecision {
 public:
  /// @param rwindow rows around the best that are no rivals
  explicit LoopDecision(std::size_t rwindow) noexcept : half_window_(rwindow / 2) {}

  /// @param scores [places], infinity for a row that no line fits
  /// @param keep_rival whether this frame's best rival stands in later, at frames whose candidates
  /// have none: D4 after a full search
  /// @param promises rows that could not all be afforded: those that have no score may be rivals by
  /// what their sketches tell
  /// @return the row with the lowest score, the lower row of equals; none when no row has a score
  /// Work: two passes over the candidates. Allocates: never.
  [[nodiscard]] std::optional<BestRow> decide(
      std::span<const double> scores, std::span<const CandidateRun> runs, bool keep_rival,
      std::span<const PromisingRows::Promise> promises) noexcept;

 private:
  std::size_t half_window_;
  std::optional<double> last_rival_;
};

}  // namespace seqloop
