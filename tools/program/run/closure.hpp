// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

#include "program/run/frame_times.hpp"
#include "program/run/other_loop.hpp"
#include "seqloop/frame_report.hpp"
#include "seqloop/ros/loop_closure.hpp"

namespace seqloop::program {

/// Whether an answer is a loop closure: accepted, with a place.
[[nodiscard]] inline bool closes_loop(const Answer& answer) noexcept {
  return answer.gate == Gate::match && answer.match.has_value();
}

/// An answer that closes a loop, as ROS 2 is told it.
/// @param times of the drive's frames
/// @param own_places whether places are frames of the drive itself
/// @param session of the place; empty where there is no map that lasts
[[nodiscard]] inline ros::LoopClosure closure_of(const Answer& answer, const FrameTimes& times,
                                                 const StampAt& stamp_ns, bool own_places,
                                                 std::string_view session) noexcept {
  const auto stamp = [&](std::uint64_t frame) {
    const std::optional<double> time_s = times.at(frame);
    return time_s ? stamp_ns(*time_s) : 0;
  };
  return {.stamp_ns = stamp(answer.frame),
          .match_stamp_ns = own_places ? stamp(answer.match->frame()) : 0,
          .frame = answer.frame,
          .match = answer.match->frame(),
          .session = session,
          .robot = {},
          .probability = static_cast<double>(answer.probability),
          .uniqueness = static_cast<double>(answer.match->uniqueness),
          .score = static_cast<double>(answer.match->score),
          .velocity = answer.match->velocity};
}

/// The same of a place of another robot.
[[nodiscard]] inline ros::LoopClosure closure_of(const OtherLoop& loop, const FrameTimes& times,
                                                 const StampAt& stamp_ns) noexcept {
  ros::LoopClosure closure = closure_of(loop.answer, times, stamp_ns, false, loop.session.view());
  closure.robot = loop.robot.view();
  return closure;
}

}  // namespace seqloop::program
