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
/// @param session of the place; empty where there is no map that lasts
[[nodiscard]] inline ros::LoopClosure closure_of(const Answer& answer, const FrameTimes& times,
                                                 const StampAt& stamp_ns,
                                                 std::string_view session) noexcept {
  const std::uint64_t place = answer.match->frame();
  const std::optional<double> taken_s = times.at(answer.frame);
  const FrameTimes::Entry* const seen = times.nearest(place);
  return {.stamp_ns = taken_s ? stamp_ns(*taken_s) : 0,
          .match_stamp_ns = seen != nullptr && seen->place == place ? stamp_ns(seen->time_s) : 0,
          .frame = answer.frame,
          .match = place,
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
  ros::LoopClosure closure = closure_of(loop.answer, times, stamp_ns, loop.session.view());
  closure.match_stamp_ns = 0;  // the number is none of this robot's
  closure.robot = loop.robot.view();
  return closure;
}

}  // namespace seqloop::program
