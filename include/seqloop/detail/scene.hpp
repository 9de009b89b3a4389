// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_proposals.hpp"
#include "seqloop/detail/descriptor_rows.hpp"
#include "seqloop/detail/query_history.hpp"
#include "seqloop/detail/sketch.hpp"
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

/// Chances that a row goes on by 0, 1 or 2 with a frame.
using Moves = std::array<double, 3>;

/// Those where nothing tells whether the robot stands.
inline constexpr Moves of_unseen_motion{0.45, 0.40, 0.15};

/// How unlike the newest frame and the rows of the map usually are, as shares of differing bits,
/// and what the frame tells that those before it did not.
struct Scene {
  /// A frame that is less new than that tells hardly anything.
  static constexpr double least_novelty = 0.02;

  double mean;
  double deviation;
  double bias;     ///< about what the best of the rows scanned reaches by chance
  double change;   ///< from the frame before, 0 .. 1
  double novelty;  ///< as much of it as leads away from what was seen, 0 .. change

  /// Whether it tells more than hardly anything.
  [[nodiscard]] bool drives() const noexcept { return novelty > least_novelty; }

  /// Chances that rows go on by 0, 1 or 2 with this frame: a robot that stands may as well stay.
  [[nodiscard]] const Moves& moves() const noexcept {
    static constexpr Moves moving{0.06, 0.88, 0.06};
    return drives() ? moving : of_unseen_motion;
  }

  /// How much more alike than rows usually are, in their deviations.
  /// @param share of bits in which the sketches differ
  [[nodiscard]] double likeness(double share) const noexcept { return (mean - share) / deviation; }

  /// How alike frame and row are: 1, the same; 0, as rows usually are. 0 where all rows show what
  /// the frame does. @param share as `likeness` has it
  [[nodiscard]] double alike(double share) const noexcept {
    return mean > 0.0 ? 1.0 - squared_chord(share) / squared_chord(mean) : 0.0;
  }
};

/// Frames, and rows, that lie so far apart are compared.
inline constexpr std::size_t frames_apart = 8;

/// The newest frame, and the one `frames_apart` before it; none: there is none.
struct FramePair {
  CloseSketch newest;
  std::optional<CloseSketch> before;
  double way = 0.0;  ///< between them, as `squared_way` has it
};

/// Square of the distance between two frames. @param sketches grows by one
[[nodiscard]] double squared_way(const DescriptorRows& frames, std::size_t a, std::size_t b,
                                 std::size_t& sketches) noexcept;

/// Share of bits in which a frame differs from a row of the map. @param sketches grows by one
[[nodiscard]] double share_of_bits(const PlaceMap& map, CloseSketch frame, std::size_t row,
                                   std::size_t& sketches) noexcept;

/// What a frame says for a row of the map.
struct RowGain {
  double gain;            ///< by novelty, ln of how much likelier the frame is there, -1.5 .. 3
  double without_bounds;  ///< the same as it was before it was bounded
  double contrast;  ///< how much more alike than the frames and rows that lie a little off; 0 where
                    ///< there is no such frame
  double here;      ///< share of bits in which the newest frame differs from the row
  double before;    ///< the same of the frame before; 0 where there is none
};

/// Pairs of sketches that `gain_of` compares at most.
inline constexpr std::size_t most_sketches_of_gain = 4;

/// @param rows of the map that may be searched
/// @param sketches grows by the pairs compared
[[nodiscard]] RowGain gain_of(const Scene& scene, const PlaceMap& map, std::size_t rows,
                              const FramePair& frames, std::size_t row,
                              std::size_t& sketches) noexcept;

/// Pairs of sketches that `in_step` compares.
inline constexpr std::size_t sketches_of_in_step = 2;

/// How far the places along a trace have changed as the frames did, from the one before to the
/// newest: .54 if they are the same pictures, 0 if they have nothing to do with them, and less
/// where they look like the frames but change in another way. Source: src/README.md, section 6.2.
/// @param scene  whose mean is above 0
/// @param frames both
/// @param at     of the trace's row at the newest frame
/// @param from   the trace's row at the frame before
/// @param sketches grows by the pairs compared
[[nodiscard]] double in_step(const Scene& scene, const PlaceMap& map, const FramePair& frames,
                             const RowGain& at, std::size_t from, std::size_t& sketches) noexcept;

/// Makes the scene of each frame. Source: src/README.md, sections 6.1 and 6.2.
class SceneGauge {
 public:
  /// Frames before the newest one that are looked back on.
  static constexpr std::size_t reach = 20;

  /// Fewer rows than that tell nothing of how unlike places usually are.
  static constexpr std::size_t least_rows = 20;

  /// Pairs of sketches that one call compares at most.
  static constexpr std::size_t most_sketches = 2;

  /// Allocates: from the arena only.
  SceneGauge(Arena& arena, bool used);

  /// @param sketches grows by the pairs compared
  /// @return none with too few rows to tell
  /// Work: the rows scanned, and 4 exponentials. Allocates: never.
  [[nodiscard]] std::optional<Scene> look(const SceneView& view, std::size_t& sketches) noexcept;

 private:
  std::span<std::uint32_t> histogram_;  // [bits + 1] of the scan
};

}  // namespace seqloop
