// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/descriptor_rows.hpp"
#include "seqloop/detail/query_history.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// How far to the side the drive's pictures have to be moved to show what the places of the map do:
/// the robot drives beside its old track, or its camera has been turned. It is learnt from places
/// where the robot is believed to be, in halves of a descriptor's columns, and stays 0 where these
/// are not known. Source: src/README.md, section 5.13.
class SidewaysShift {
 public:
  /// Rows to either side of a frame's that have to be less like it.
  static constexpr std::size_t rows_beside = 2;

  /// Rows to either side that the frame may show as it came.
  static constexpr std::size_t rows_unmoved = 6;

  /// Pairs of descriptors that a frame is compared by.
  static constexpr std::size_t distances = 3 + 2 * rows_beside + 2 * rows_unmoved;

  /// @param form of what is compared
  /// @param on   whether frames may be moved at all
  /// Allocates: from the arena only.
  SidewaysShift(Arena& arena, const DescriptorForm& form, bool on);

  /// The values of a descriptor stand in so many columns, side by side; 0 or 1: nothing can be
  /// moved.
  void stand_in(std::size_t columns) noexcept;

  /// What a frame has to be moved by, in halves of a column: what it shows there moves to the left
  /// where this is above 0.
  [[nodiscard]] int halves() const noexcept { return now_; }

  /// A frame as it would look from where the places were seen. What is outside the picture is taken
  /// to go on as at its edge.
  /// @param descriptor [D] unit L2, as all frames' here
  /// @return [D] unit L2 or zero; the same where nothing is to be moved; valid until the next call
  /// Work: D. Allocates: never.
  [[nodiscard]] std::span<const float> moved(std::span<const float> descriptor) noexcept {
    return moved_by(descriptor, now_);
  }

  /// Takes what the newest frame shows of the place where the robot is believed to be. Where the
  /// robot turns, or looks to the side, a row too far on or back looks like one that is moved. So
  /// nothing is learnt where a row beside it looks clearly more like the frame, and a row near by
  /// that is much more like the frame as it came speaks for moving it less.
  /// @param queries    whose newest frame was `moved` by what holds now
  /// @param descriptor [D] of that frame, as it came
  /// @param news       of the frame: its novelty by the belief in the place, 0 .. 1
  /// @return distances that were computed: `distances` at most
  /// Work: these, and twice D. Allocates: never.
  std::size_t learn(const QueryHistory& queries, std::span<const float> descriptor,
                    const PlaceMap& map, std::size_t row, double news) noexcept;

  /// Nobody knows where the robot is. After 200 such frames since something was learnt last nobody
  /// knows of its track, either: it may be on another side.
  void learn_nothing() noexcept {
    constexpr std::size_t most_lost = 200;
    if (++lost_ > most_lost) begin();
  }

  /// Another drive begins.
  void begin() noexcept {
    now_ = 0;
    seen_ = more_ = less_ = 0.0;
    lost_ = 0;
  }

 private:
  void go_on() noexcept;
  [[nodiscard]] std::span<const float> moved_by(std::span<const float> descriptor,
                                                int halves) noexcept;

  std::size_t columns_ = 0;
  int most_ = 0;  // halves, to either side
  int now_ = 0;
  std::size_t lost_ = 0;    // frames of a lost robot, since something was learnt last
  double seen_ = 0.0;       // what was new of the frames that were learnt from
  double more_ = 0.0;       // how much more alike they would be with one half more, a mean
  double less_ = 0.0;       // with one less
  DescriptorRows frame_;    // [1], as it is compared
  std::span<float> moved_;  // [D]
};

}  // namespace seqloop
