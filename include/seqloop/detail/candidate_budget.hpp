// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_runs.hpp"
#include "seqloop/detail/difference_slices.hpp"
#include "seqloop/detail/trajectories.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// The rows that a frame is compared with, their differences computed. Where the detector
/// relocalises, a frame has a budget of distances, spent in the order in which ranges are added:
/// what one frame could only begin, the next one finds begun. Source: src/README.md,
/// section 5.5.
class CandidateBudget {
 public:
  /// Allocates: from the arena only.
  CandidateBudget(Arena& arena, const MatcherConfig& config);

  /// The most rows that a frame is compared with, and distances that these cost, where the detector
  /// relocalises.
  [[nodiscard]] static std::size_t most_rows(const MatcherConfig& config) noexcept {
    return 3 * (config.num + 1);
  }

  /// The window of differences that lines run through.
  struct Window {
    DifferenceSlices* slices;
    const PlaceMap* map;
    const Trajectories* trajectories;
    std::uint64_t first;  ///< frame that belongs together with the newest
    std::uint64_t end;    ///< the frame after the newest, which the last column is of
    std::size_t rows;     ///< rows of the map that lines may touch
  };

  /// Begins the next frame.
  void clear() noexcept;

  /// Computes the differences that lines through a range of rows can touch, and takes the rows in.
  /// Where not all of them can be afforded, as many around the middle as can; where not even one,
  /// what can be computed is: the next frames need it too.
  /// Work: distances, up to the limit. Allocates: never.
  void add(const Window& window, CandidateRun range) noexcept;

  /// @return in rising order, disjoint, not touching
  [[nodiscard]] std::span<const CandidateRun> runs() const noexcept { return runs_.runs(); }

  /// Distances that were computed since `clear`.
  [[nodiscard]] std::size_t distances() const noexcept { return distances_; }

 private:
  /// The same for rows of one session.
  void add_part(const Window& window, CandidateRun range) noexcept;

  struct Cost {
    std::size_t rows = 0;
    std::size_t distances = 0;
    // The oldest frame of which there is anything to compute.
    std::uint64_t oldest = std::numeric_limits<std::uint64_t>::max();
  };
  [[nodiscard]] Cost cost(const Window& window, CandidateRun range) const noexcept;
  /// Whether nothing of a range has to be computed.
  [[nodiscard]] bool complete(const Window& window, CandidateRun range) const noexcept;
  /// @param oldest frame of which there may be anything to compute
  void compute(const Window& window, CandidateRun range, std::uint64_t oldest, bool fits) noexcept;

  bool limited_;
  std::size_t most_rows_;
  std::size_t most_distances_;
  CandidateRuns runs_;
  std::size_t rows_ = 0;
  std::size_t distances_ = 0;
};

}  // namespace seqloop
