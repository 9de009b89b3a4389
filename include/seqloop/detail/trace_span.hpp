// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/belief_traces.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// On which frames of a trace the robot was on it: it may have come onto the map later than the
/// trace says, have left it already, or have been elsewhere in between. A smoother, forward and
/// backward, over three states. In a drive that closes loops the newest frame is on the trace, or
/// before it: the last frames of any revisit look like what wrong rows see, so that they tell no
/// end. The doubt does (`PlaceBelief::remember`). Source: src/README.md, section 6.6.
class TraceSpan {
 public:
  /// @param use  whether the drive closes loops
  /// @param most frames of a trace. Allocates: from the arena only.
  TraceSpan(Arena& arena, Use use, std::size_t most);

  /// Probabilities that a frame lies on the trace, if the trace is right.
  struct On {
    double still;  ///< if the trace goes on
    double left;   ///< if it was left, since the newest frame at the latest
    [[nodiscard]] double where(bool was_left) const noexcept { return was_left ? left : still; }
  };

  /// Says what each frame has to gain. Where roads meet, the frames that lead there look alike: in
  /// a drive that closes loops each has to gain .7 of what they gain on average. Frames that were
  /// moved to the side alike are as like their places as that lets them be: each run of them has an
  /// average of its own.
  /// @param trace the newest frame first
  /// @param least what a frame has to gain at least, by novelty; 0 or more
  void ask(std::span<BeliefTraces::Step> trace, double least) const noexcept;

  /// @param trace  the newest frame first; at most `most`
  /// @param before that the oldest frame lies on the trace, as was known before, 0 .. 1
  /// @param usual  what wrong rows gain, by novelty; 0 or more
  /// @param novelty what is usually new of this drive's frames, 0 .. 1
  /// @param jumps  the chance that the robot is carried away with a frame, beyond what is usual, 0
  ///               .. 0.5. The higher it is, the less does `before` speak for the oldest frame
  /// @param asked  frames that it is asked for, from the newest on; at most those of the trace
  /// @return [asked] frame by frame as the trace; until the next call
  /// Work: as many exponentials as the trace has frames, twice where loops are closed. Allocates:
  /// never.
  std::span<const On> find(std::span<const BeliefTraces::Step> trace, double before, double usual,
                           double novelty, double jumps, std::size_t asked) noexcept;

 private:
  /// How likely the frames so far are, by where the robot is: not on the trace yet, on it, gone.
  struct Forward {
    double fresh;
    double on;
    double gone;
    double likelier;       // the frame, on the trace than before it
    double gone_likelier;  // the frame, after the trace than before it
  };

  [[nodiscard]] double likelier_when_gone(const BeliefTraces::Step& step,
                                          double usual) const noexcept;

  bool localises_;
  std::span<Forward> forward_;  // [most]
  std::span<On> on_;            // [most]
};

}  // namespace seqloop
