// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// Which step of the matcher each of the newest frames is. A keyframe is a step of its own; the
/// frames after it that are none are the same step.
class FrameSteps {
 public:
  /// @param steps that are remembered   @param frames likewise; 0 both: each frame is a step
  /// Allocates: from the arena only.
  FrameSteps(Arena& arena, std::size_t steps, std::size_t frames)
      : frame_of_(arena.take<std::uint64_t>("frames of keyframes",
                                            steps == 0 ? 0 : std::bit_ceil(steps))),
        step_of_(arena.take<std::uint64_t>("keyframes of frames",
                                           frames == 0 ? 0 : std::bit_ceil(frames))) {}

  /// What a step shows beside the one before it: the same, or nothing that could be seen; something
  /// new; or nothing that has to do with it.
  enum class Shows : std::uint8_t { the_same, something_new, another_scene };

  /// The next frame is a step. @param settled what `frames_of` tells of its frames
  void take(bool settled, Shows shows) noexcept {
    settled_ = settled;
    if (!frame_of_.empty()) {
      const bool same = shows == Shows::the_same;
      const bool cut = shows == Shows::another_scene;
      frame_of_[slot(frame_of_, steps_)] = frames_ | (cut ? flag : 0) | (same ? second_flag : 0);
    }
    ++steps_;
    repeat();
  }

  /// The next frame is the newest step.
  void repeat() noexcept { note((steps_ - 1) | (settled_ ? 0 : flag)); }

  /// So many frames never came, and as many steps, or fewer, went by with them.
  void skip(std::uint64_t frames, std::uint64_t steps) noexcept {
    const std::uint64_t first = frames_;
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(frames, step_of_.size()); ++i) {
      step_of_[slot(step_of_, first + i)] = none;
    }
    for (std::uint64_t i = 0; i < steps; ++i, ++steps_) {
      if (!frame_of_.empty())
        frame_of_[slot(frame_of_, steps_)] = (first + frames * i / steps) | second_flag;
    }
    frames_ += frames;
  }

  /// Frames so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

  /// The first frame of a step that is remembered.
  [[nodiscard]] std::uint64_t frame_of(std::uint64_t step) const noexcept {
    return frame_of_.empty() ? step : frame_of_[slot(frame_of_, step)] & ~(flag | second_flag);
  }

  /// Whether a step, and those that show the same, have nothing to do with what came before them,
  /// nor with what comes after. Work: `PlaceMap::most_looks` steps at most, either way.
  [[nodiscard]] bool is_isolated(std::uint64_t step) const noexcept {
    std::uint64_t first = step;
    while (shows_the_same(first) && first > 0 && step - first < PlaceMap::most_looks) --first;
    std::uint64_t next = step + 1;
    while (shows_the_same(next) && next - step <= PlaceMap::most_looks) ++next;
    return is_cut(first) && is_cut(next);
  }

  /// Whether more than a frame shows what a step does, so far as is known.
  [[nodiscard]] bool repeats(std::uint64_t step) const noexcept {
    return frames_in(step) > 1 || shows_the_same(step) || shows_the_same(step + 1);
  }

  /// Steps at which the robot stood, for long at one of them: as `PlaceMap::stop_at` has it.
  struct Stop {
    std::uint64_t came;                 ///< the first frame
    bool seen_to_come;                  ///< whether the step before it leads to it
    std::optional<std::uint64_t> left;  ///< the first frame after it, if it has come
  };

  /// The stop that a step is part of, or comes right before or after.
  /// Work: `PlaceMap::most_looks` steps at most, either way. Allocates: never.
  [[nodiscard]] std::optional<Stop> stop_at(std::uint64_t step) const noexcept {
    std::uint64_t off = 0;
    const auto before = [&] { return step - std::min(step, off); };
    while (off <= PlaceMap::beside_stops && !stands_long(step + off) && !stands_long(before()))
      ++off;
    if (off > PlaceMap::beside_stops) return std::nullopt;
    std::uint64_t first = stands_long(step + off) ? step + off : before();
    std::uint64_t last = first;
    const std::uint64_t end = std::min(steps_, step + PlaceMap::most_looks);
    for (std::uint64_t at = last + 1; at < end && at - last <= PlaceMap::between_stops; ++at) {
      if (repeats(at)) last = at;
    }
    const std::uint64_t begin = step - std::min<std::uint64_t>(step, PlaceMap::most_looks);
    for (std::uint64_t at = first; at-- > begin && first - at <= PlaceMap::between_stops;) {
      if (repeats(at)) first = at;
    }
    return Stop{frame_of(first), first > 0 && !is_cut(first),
                last + 1 < steps_ ? std::optional(frame_of(last + 1)) : std::nullopt};
  }

  /// Calls `tell(frame, settled)` for the frames that are a step, in order.
  template <class Tell>
  void frames_of(std::uint64_t step, Tell tell) const noexcept {
    for (std::uint64_t frame = frame_of(step); frame < frames_; ++frame) {
      const std::uint64_t noted = step_of_[slot(step_of_, frame)];
      const std::uint64_t its = noted == none ? none : noted & ~flag;
      if (its == step) tell(frame, noted == its);
      if (its != step && its != none) return;
    }
  }

 private:
  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::uint64_t flag = std::uint64_t{1} << 63;
  static constexpr std::uint64_t second_flag = std::uint64_t{1} << 62;

  /// So far as is known; 0: the step has not come.
  [[nodiscard]] std::uint64_t frames_in(std::uint64_t step) const noexcept {
    if (step >= steps_) return 0;
    return (step + 1 < steps_ ? frame_of(step + 1) : frames_) - frame_of(step);
  }

  [[nodiscard]] bool stands_long(std::uint64_t step) const noexcept {
    return frames_in(step) > PlaceMap::stop_frames;
  }

  [[nodiscard]] bool has(std::uint64_t step, std::uint64_t which) const noexcept {
    return step < steps_ && !frame_of_.empty() && (frame_of_[slot(frame_of_, step)] & which) != 0;
  }

  [[nodiscard]] bool is_cut(std::uint64_t step) const noexcept { return has(step, flag); }

  [[nodiscard]] bool shows_the_same(std::uint64_t step) const noexcept {
    return has(step, second_flag);
  }

  /// Rings are as long as a power of two.
  [[nodiscard]] static std::size_t slot(std::span<const std::uint64_t> ring,
                                        std::uint64_t number) noexcept {
    return static_cast<std::size_t>(number) & (ring.size() - 1);
  }

  void note(std::uint64_t step) noexcept {
    if (!step_of_.empty()) step_of_[slot(step_of_, frames_)] = step;
    ++frames_;
  }

  std::uint64_t frames_ = 0;
  std::uint64_t steps_ = 0;
  bool settled_ = true;                // the newest
  std::span<std::uint64_t> frame_of_;  // by step, with flags for what it shows
  std::span<std::uint64_t> step_of_;   // by frame, with a flag where it is not settled
};

}  // namespace seqloop
