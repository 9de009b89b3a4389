// SPDX-License-Identifier: MIT
// How fast a drive goes: cruising, slow-downs and halts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace seqloop::street {

/// Positions of every frame along a drive: the first at 0, the last at `length`, never backwards.
/// From 60 frames on there is a slow-down and a halt of 4 to 6 frames in about every 180.
/// @param frames 1 or more. @param length metres.
std::vector<double> positions(std::size_t frames, double length, std::uint64_t seed);

}  // namespace seqloop::street
