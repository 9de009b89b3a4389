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

  /// The next frame is a step.
  /// @param settled what `frames_of` tells of its frames
  /// @param cut     whether it has nothing to do with the step before it
  void take(bool settled, bool cut) noexcept {
    settled_ = settled;
    if (!frame_of_.empty()) frame_of_[slot(frame_of_, steps_)] = frames_ | (cut ? flag : 0);
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
      if (!frame_of_.empty()) frame_of_[slot(frame_of_, steps_)] = first + frames * i / steps;
    }
    frames_ += frames;
  }

  /// Frames so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

  /// The first frame of a step that is remembered.
  [[nodiscard]] std::uint64_t frame_of(std::uint64_t step) const noexcept {
    return frame_of_.empty() ? step : frame_of_[slot(frame_of_, step)] & ~flag;
  }

  /// Whether a step has nothing to do with the one before it, nor with the one after it.
  [[nodiscard]] bool is_isolated(std::uint64_t step) const noexcept {
    return is_cut(step) && step + 1 < steps_ && is_cut(step + 1);
  }

  /// The first frame after a step and the stop that it is part of, or is at most one frame before,
  /// if it has come. Steps of several frames with one frame at most between two are one stop.
  /// Work: `most_looks` steps at most. Allocates: never.
  [[nodiscard]] std::optional<std::uint64_t> left(std::uint64_t step) const noexcept {
    std::uint64_t end = step;
    for (std::uint64_t at = step + 1; at < std::min(steps_, step + most_looks); ++at) {
      if (repeats(at)) end = at;
      if (at - end == between_stops) break;
    }
    return end + 1 < steps_ ? std::optional(frame_of(end + 1)) : std::nullopt;
  }

  /// Whether a step is more than a frame, so far as is known.
  [[nodiscard]] bool repeats(std::uint64_t step) const noexcept {
    return (step + 1 < steps_ ? frame_of(step + 1) : frames_) > frame_of(step) + 1;
  }

  /// Whether a step, or one beside it, is more than a frame.
  [[nodiscard]] bool stands(std::uint64_t step) const noexcept {
    return repeats(step) || (step > 0 && repeats(step - 1)) ||
           (step + 1 < steps_ && repeats(step + 1));
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
  static constexpr std::uint64_t between_stops = 2;
  static constexpr std::uint64_t most_looks = 100;

  [[nodiscard]] bool is_cut(std::uint64_t step) const noexcept {
    return !frame_of_.empty() && (frame_of_[slot(frame_of_, step)] & flag) != 0;
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
  std::span<std::uint64_t> frame_of_;  // by step, with a flag where it is a cut
  std::span<std::uint64_t> step_of_;   // by frame, with a flag where it is not settled
};

}  // namespace seqloop
