// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/clock.hpp"

namespace seqloop::live {

/// What waits looks so often whether it is to stop.
constexpr Nanoseconds time_step = std::chrono::milliseconds(50);

}  // namespace seqloop::live
