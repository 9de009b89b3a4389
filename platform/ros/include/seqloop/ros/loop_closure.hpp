// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace seqloop::ros {

/// What `msg/LoopClosure.msg` says of an accepted answer.
struct LoopClosure {
  std::int64_t stamp_ns = 0;        ///< when the frame was taken, since 1970
  std::int64_t match_stamp_ns = 0;  ///< when the place was seen; 0: not known
  std::uint64_t frame = 0;
  std::uint64_t match = 0;
  std::string_view session = {};  ///< of the place; empty: there is no map that lasts
  std::string_view robot = {};    ///< of a fleet; empty: this one
  double probability = 0.0;       ///< NaN: decided by uniqueness
  double uniqueness = 0.0;        ///< NaN: none
  double score = 0.0;
  double velocity = 0.0;
};

/// @return the message as ROS 2 serialises it
[[nodiscard]] std::vector<std::uint8_t> message_of(const LoopClosure& closure);

/// @return `msg/LoopClosure.msg` and all that it is made of, as bags hold definitions
[[nodiscard]] std::string loop_closure_definition();

}  // namespace seqloop::ros
