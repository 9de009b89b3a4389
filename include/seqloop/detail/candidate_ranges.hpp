// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_runs.hpp"
#include "seqloop/detail/place_order.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// Decides which rows of the map a frame is compared with: all of them, K ranges around the last
/// frame's best rows (Algorithm 4), or the same with K adapted online (Algorithm 5).
class CandidateRanges {
 public:
  /// Allocates: from the arena only.
  CandidateRanges(Arena& arena, const MatcherConfig& config);

  /// This frame's candidates. @param rows rows of the map that may be searched
  /// @return the best first; they may overlap; none when there are no rows, or none are
  /// known where no full search is made. Work: K. Allocates: never.
  [[nodiscard]] std::span<const CandidateRun> choose(const PlaceOrder& order,
                                                     std::size_t rows) noexcept;

  /// Whether the last choice was all rows.
  [[nodiscard]] bool full_search() const noexcept { return full_search_; }

  /// [row - Num/2, row + Num/2], clipped to the rows of its session that may be searched.
  [[nodiscard]] CandidateRun around(const PlaceOrder& order, std::size_t row,
                                    std::size_t rows) const noexcept;

  /// K in force; 0 where all rows are always candidates.
  [[nodiscard]] std::size_t k() const noexcept { return k_; }

  /// Learns from the frame that was just searched, for the next one.
  /// @param scores [places] of the rows in `runs`, infinity for a row that no line fits
  /// @param match  the best row; none when no candidate had a score: the next frame searches all
  /// @param change_degree CD of the frame, Eq. (4); only Algorithm 5 asks for it
  /// Work: candidates * K at worst. Allocates: never.
  void update(std::span<const double> scores, std::span<const CandidateRun> runs,
              std::optional<std::size_t> match, double change_degree) noexcept;

  /// Frames went by unseen: each moves the last frame's best rows one row further on,
  /// as they do at velocity 1. Work: K.
  void skip(const PlaceOrder& order, std::uint64_t frames) noexcept;

  /// Forgets the last frame: the next one searches all, K starts anew.
  void restart() noexcept;

  /// A row went from the map: those behind it are counted one lower. Work: K.
  void removed(std::size_t row) noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept;

 private:
  struct ScoredRow {
    double score;
    std::size_t row;
  };

  void adapt_k(std::size_t match, double change_degree) noexcept;
  void rank(std::span<const double> scores, std::span<const CandidateRun> runs) noexcept;

  Candidates kind_;
  bool searches_all_;       // every L-th matched frame, and when nothing is known
  std::size_t half_range_;  // Num / 2
  std::size_t reinit_;      // L
  std::size_t initial_k_;   // K0

  std::size_t k_;
  bool full_search_ = true;
  std::size_t matched_frames_ = 0;
  std::size_t ranked_count_ = 0;
  std::size_t recorded_ = 0;          // how many IML since the last change of K
  std::size_t recorded_maximum_ = 0;  // their maximum
  std::span<ScoredRow> ranked_;       // [max K], T: the last frame's candidates, best first
  std::span<CandidateRun> ranges_;    // [max K]
};

}  // namespace seqloop
