// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/belief_traces.hpp"
#include "seqloop/detail/descriptor_rows.hpp"
#include "seqloop/detail/scene.hpp"

namespace seqloop {

/// The sketches of a drive's first frames. A row is often found only some frames after the robot
/// was switched on beside it; its trace is then followed back to where the drive began.
/// Source: src/README.md, section 6.6.
class FirstFrames {
 public:
  /// Frames that are kept.
  static constexpr std::size_t most = 20;

  /// Pairs of sketches that one call of `follow` compares at most.
  static constexpr std::size_t most_sketches = most * (3 + most_sketches_of_gain);

  /// Allocates: from the arena only.
  FirstFrames(Arena& arena, bool used);

  /// The drive begins anew: nothing is kept.
  void restart() noexcept { count_ = 0; }

  /// Takes the newest frame, if it is the drive's first or follows those that are kept, and there
  /// is room.
  void take(const SceneView& view, const Scene& scene) noexcept;

  /// Frames went by unseen: the scene stands still.
  void repeat(std::uint64_t frames) noexcept;

  /// Follows a trace that began with a later frame back to the first one, row by row to the most
  /// alike of those that it may have come from.
  /// @param trace  the newest frame first; undefined from `count` on, or followed
  /// @param count  frames of it, from the newest on; at least 1
  /// @param newest frame
  /// @param sketches grows by the pairs compared
  /// @return frames of it now: `count` if it did not begin with a frame that follows one of those
  ///         that are kept, or the robot came from before the session; never more than `trace` has
  ///         room for
  /// Work: `most_sketches`, three exponentials a frame. Allocates: never.
  std::size_t follow(const PlaceMap& map, std::span<BeliefTraces::Step> trace, std::size_t count,
                     std::uint64_t newest, std::size_t& sketches) const noexcept;

 private:
  static constexpr std::size_t words = DescriptorRows::close_words;

  [[nodiscard]] CloseSketch sketch(std::size_t frame) const noexcept {
    return CloseSketch(&sketches_[frame * words], words);
  }

  std::uint64_t first_ = 0;  // frame
  std::size_t count_ = 0;
  std::size_t rows_ = 0;               // of the map that may be searched
  std::span<Scene> scenes_;            // [most]
  std::span<std::uint64_t> sketches_;  // [most, words]
};

}  // namespace seqloop
