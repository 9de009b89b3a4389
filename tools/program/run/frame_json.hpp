// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "seqloop/budget.hpp"

namespace seqloop::program {

/// What the loop as a whole was doing at a frame.
struct LoopState {
  Misses missed;            ///< limits that the frame broke
  bool overloaded = false;  ///< the overload policy is in force
};

/// Names of the limits that a frame broke.
[[nodiscard]] std::vector<std::string_view> names(const Misses& missed);

/// What `run` says of one frame. What it does not have is null.
[[nodiscard]] nlohmann::ordered_json frame_json(const ProcessedFrame& processed,
                                                const LoopState& state);

/// What is said of one frame in the end: `frame`, `status`, `match`, `probability` and so on.
[[nodiscard]] nlohmann::ordered_json answer_json(const Answer& answer);

/// Adds answers to those that it has, all in order of their frames. The last of them stands in the
/// keys beside them, too.
void add_answers(nlohmann::ordered_json& frame, std::span<const Answer> answers);

/// Leaves out its answers, and what the last of them says beside `frame` and `status`.
void leave_out_answers(nlohmann::ordered_json& frame);

}  // namespace seqloop::program
