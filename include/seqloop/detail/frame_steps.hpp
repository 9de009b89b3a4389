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
#include "seqloop/detail/stop_run.hpp"

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
      const std::uint64_t bits = shows == Shows::the_same        ? same
                                 : shows == Shows::another_scene ? cut
                                                                 : 0;
      frame_of_[slot(frame_of_, steps_)] = frames_ | bits;
    }
    ++steps_;
    repeat();
  }

  /// The next frame is the newest step.
  void repeat() noexcept { note((steps_ - 1) | (settled_ ? 0 : unsettled)); }

  /// So many frames never came, or showed nothing. They are part of no step.
  void skip(std::uint64_t frames) noexcept {
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(frames, step_of_.size()); ++i) {
      step_of_[slot(step_of_, frames_ + i)] = none;
    }
    frames_ += frames;
  }

  /// So many steps went by with the newest frames. @param frames of which nothing is known, as many
  /// as steps or more
  void pass(std::uint64_t steps, std::uint64_t frames) noexcept {
    const std::uint64_t first = frames_ - frames;
    for (std::uint64_t i = 0; i < steps; ++i, ++steps_) {
      if (!frame_of_.empty())
        frame_of_[slot(frame_of_, steps_)] = (first + frames * i / steps) | same;
    }
  }

  /// Frames so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

  /// The first frame of a step that is remembered.
  [[nodiscard]] std::uint64_t frame_of(std::uint64_t step) const noexcept {
    return frame_of_.empty() ? step : frame_of_[slot(frame_of_, step)] & ~(cut | same);
  }

  /// Whether a step, and those that show the same, have nothing to do with what came before them,
  /// nor with what comes after. Work: `StopRun::reach` steps at most, either way.
  [[nodiscard]] bool is_isolated(std::uint64_t step) const noexcept {
    std::uint64_t first = step;
    while (shows_the_same(first) && first > 0 && step - first < StopRun::reach) --first;
    std::uint64_t next = step + 1;
    while (shows_the_same(next) && next - step <= StopRun::reach) ++next;
    return is_cut(first) && is_cut(next);
  }

  /// Whether more than a frame shows what a step does, so far as is known.
  [[nodiscard]] bool repeats(std::uint64_t step) const noexcept {
    return frames_in(step) > 1 || shows_the_same(step) || shows_the_same(step + 1);
  }

  /// A `StopRun` of steps.
  struct Stop {
    std::uint64_t came;                 ///< the first frame
    bool seen_to_come;                  ///< whether the step before it leads to it
    std::optional<std::uint64_t> left;  ///< the first frame after it, if it has come
  };

  /// The stop that a step is part of, or is beside. Work: `StopRun::around`. Allocates: never.
  [[nodiscard]] std::optional<Stop> stop_at(std::uint64_t step) const noexcept {
    const std::uint64_t begin = step - std::min(step, StopRun::reach);
    const auto run = StopRun::around(
        step, begin, std::min(steps_, step + StopRun::reach + 1), [this](std::uint64_t one) {
          return repeats(one) ? std::max<std::uint64_t>(frames_in(one), 2) - 1 : 0;
        });
    if (!run) return std::nullopt;
    return Stop{frame_of(run->first), run->first > 0 && !is_cut(run->first),
                run->last + 1 < steps_ ? std::optional(frame_of(run->last + 1)) : std::nullopt};
  }

  /// Calls `tell(frame, settled)` for the frames that are a step, in order.
  template <class Tell>
  void frames_of(std::uint64_t step, Tell tell) const noexcept {
    for (std::uint64_t frame = frame_of(step); frame < frames_; ++frame) {
      const std::uint64_t noted = step_of_[slot(step_of_, frame)];
      const std::uint64_t its = noted == none ? none : noted & ~unsettled;
      if (its == step) tell(frame, noted == its);
      if (its != step && its != none) return;
    }
  }

 private:
  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::uint64_t unsettled = std::uint64_t{1} << 63;  // in step_of_
  static constexpr std::uint64_t cut = std::uint64_t{1} << 63;        // in frame_of_
  static constexpr std::uint64_t same = std::uint64_t{1} << 62;       // likewise

  /// So far as is known; 0: the step has not come.
  [[nodiscard]] std::uint64_t frames_in(std::uint64_t step) const noexcept {
    if (step >= steps_) return 0;
    return (step + 1 < steps_ ? frame_of(step + 1) : frames_) - frame_of(step);
  }

  [[nodiscard]] bool has(std::uint64_t step, std::uint64_t which) const noexcept {
    return step < steps_ && !frame_of_.empty() && (frame_of_[slot(frame_of_, step)] & which) != 0;
  }

  [[nodiscard]] bool is_cut(std::uint64_t step) const noexcept { return has(step, cut); }

  [[nodiscard]] bool shows_the_same(std::uint64_t step) const noexcept { return has(step, same); }

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
  std::span<std::uint64_t> frame_of_;  // by step, with a bit for what it shows
  std::span<std::uint64_t> step_of_;   // by frame, with a bit where it is not settled
};

}  // namespace seqloop
