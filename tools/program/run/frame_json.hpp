// SPDX-License-Identifier: MIT
#pragma once

#include <string>
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

/// One line of `run`'s output, newline included. What a frame does not have is null.
[[nodiscard]] std::string frame_json(const ProcessedFrame& processed, const LoopState& state);

}  // namespace seqloop::program
