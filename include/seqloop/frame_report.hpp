// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace seqloop {

/// How far a frame came, in the order of the pipeline.
enum class Gate : std::uint8_t {
  no_frame,      ///< a live source brought no frame in time, or lost its camera
  frame_error,   ///< the newest frame could not be read or described
  warming_up,    ///< no answer is due yet: fewer than ds + 1 frames have been seen
  waiting,       ///< no answer is due: the frames that wait for theirs are not sure yet
  no_candidate,  ///< no line fits into the rows that may be searched
  not_unique,    ///< `Decision::uniqueness`: another row stands out nearly as much as the best
  new_place,     ///< the robot is somewhere new, for all that is known
  unsure,        ///< it may have been here before, but the evidence does not suffice
  match          ///< the robot has been here before
};

/// How many gates there are.
inline constexpr std::size_t gates = 9;

/// `no_frame`, `frame_error`, ...
[[nodiscard]] std::string_view name(Gate gate) noexcept;

/// The gate of that name; none: no gate has it.
[[nodiscard]] std::optional<Gate> gate_of(std::string_view name) noexcept;

/// The best row of the map for a frame.
struct Match {
  /// The place at the centre column, by its number: places are counted from 0 as they are added,
  /// with those that a full map forgets, and the frames between them that were no keyframes or
  /// found no room.
  std::uint64_t place = 0;
  /// Mean difference along the line, 0 .. 2; smaller is more certain. NaN where no line leads to
  /// the place, which evidence over time speaks for.
  float score = 0.0F;
  /// Score by the runner-up's score: 0 .. 1; above 1 or infinite when the runner-up of the last
  /// full search had to stand in and is better, or evidence over time speaks for another line than
  /// the best; NaN where not defined.
  float uniqueness = 0.0F;
  double velocity = 0.0;   ///< rows a keyframe; NaN for single frames, and without a line
  std::uint64_t head = 0;  ///< the place at the newest column
  /// `Decision::uniqueness`: the place of that runner-up; none where one of an earlier frame, or
  /// nothing, stood in.
  std::optional<std::uint64_t> runner_up = std::nullopt;
  /// Frames after the place's own, at which the robot stood there: in a map of one drive, where it
  /// stood then and now, how far that stop had got.
  std::uint64_t stood = 0;

  /// The frame of the place's drive that shows what the answer's does: a place, or one at which the
  /// robot still stood there. Like `place` a number of the map, over all of its sessions, while
  /// `Answer::frame` is counted from 0 in each drive: frame f of a drive that is added has the
  /// number n + f, where n was `map.order().next_number()` as its detector was made. Back from a
  /// number, `map.order()` says `session_of_number` and, while the place is there, its
  /// `row_of_number`, and of that the `frame`.
  [[nodiscard]] std::uint64_t frame() const noexcept { return place + stood; }
};

/// What a frame cost. Follows from configuration and input alone, never from the machine.
struct Work {
  std::uint64_t candidates = 0;  ///< rows that got a score
  std::uint64_t distances = 0;   ///< descriptor distances computed
  std::uint64_t line_sums = 0;   ///< lines summed, of ds + 1 differences each
  std::uint64_t scanned = 0;     ///< to relocalise: places looked at by 32 bytes of their sketches
  std::uint64_t sketches = 0;    ///< to relocalise: pairs of sketches compared by 128 bytes

  bool operator==(const Work&) const = default;
};

/// What is said of one frame in the end: there is one for each frame that was stepped. By
/// uniqueness each step of a whole window answers its centre frame, even one that never came: none
/// is for the first ds/2 of a window that begins anew, for the last ds - ds/2, and for those whose
/// turn it is with frames that never come.
struct Answer {
  std::uint64_t frame = 0;  ///< counted from 0
  Gate gate = Gate::frame_error;
  /// That the robot was at `match` when it took the frame, 0 .. 1: of answers that say .9, nine in
  /// ten are right. NaN where the decision is by uniqueness.
  float probability = 0.0F;
  std::optional<Match> match;  ///< the best place, whether or not it suffices; none: nothing known
};

/// Where the robot is believed to be at the newest frame, by what has been seen so far.
struct Belief {
  std::uint64_t place = 0;   ///< the likeliest
  float probability = 0.0F;  ///< that it is there, 0 .. 1. No part of one whole with `new_place`:
                             ///< both may be low, and together they may come to more than 1
  float new_place = 1.0F;    ///< that it is somewhere the map does not know, 0 .. 1
  std::uint64_t stood = 0;   ///< as `Match::stood`

  /// As `Match::frame`.
  [[nodiscard]] std::uint64_t frame() const noexcept { return place + stood; }
};

/// What one step has to say.
struct FrameReport {
  /// The final answers that became due with this step, in order of their frames; later steps may
  /// answer earlier ones. In the detector's memory, until its next `step`, `steps` or `finish`.
  std::span<const Answer> answers;
  std::optional<Belief> now;  ///< of the newest frame; none before places can be compared

  std::uint64_t newest = 0;  ///< the frame that was stepped, from 0
  /// The last of `answers`, where there are any; then its gate and match. By uniqueness also the
  /// centre of a window that is not whole yet, which has no answer.
  std::optional<std::uint64_t> frame;
  Gate gate = Gate::frame_error;  ///< without an answer `warming_up`, `waiting`, or `frame_error`
  std::optional<Match> match;
  std::size_t k = 0;         ///< K in force for this frame; 0 where all rows are candidates
  bool full_search = false;  ///< whether all rows were candidates
  bool map_full = false;     ///< closing loops: the frame could not become a place
  Work work;
};

}  // namespace seqloop
