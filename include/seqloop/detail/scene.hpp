// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_proposals.hpp"
#include "seqloop/detail/query_history.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// What there is to see when a frame has come.
struct SceneView {
  const QueryHistory* queries;
  const PlaceMap* map;
  const CandidateProposals* seen;  ///< which have looked at this frame
  std::uint64_t newest;            ///< the frame
  std::uint64_t oldest;            ///< that belongs together with it
  std::size_t rows;                ///< of the map that may be searched
};

/// How unlike the newest frame and the rows of the map usually are, as shares of differing bits,
/// and what the frame tells that those before it did not.
struct Scene {
  double mean;
  double deviation;
  double bias;     ///< about what the best of the rows scanned reaches by chance
  double change;   ///< from the frame before, 0 .. 1
  double novelty;  ///< as much of it as leads away from what was seen, 0 .. change
};

/// Makes the scene of each frame. Source: src/README.md, sections 6.1 and 6.2.
class SceneGauge {
 public:
  /// Frames before the newest one that are looked back on.
  static constexpr std::size_t reach = 20;

  /// Pairs of sketches that one call compares at most.
  static constexpr std::size_t most_sketches = 2;

  /// Allocates: from the arena only.
  SceneGauge(Arena& arena, bool used);

  /// @param sketches grows by the pairs compared
  /// @return none with too few rows to tell
  /// Work: as many exponentials as sketches have bits at most. Allocates: never.
  [[nodiscard]] std::optional<Scene> look(const SceneView& view, std::size_t& sketches) noexcept;

 private:
  std::span<std::uint32_t> histogram_;  // [bits + 1] of the scan
};

}  // namespace seqloop
