// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "program/bench/contender.hpp"
#include "program/drives/drives.hpp"

namespace seqloop::program {

/// Describes a 640x480 colour frame with the built-in descriptor, and with what is asked for beside
/// it.
void time_describing(const DriveSettings& drive, std::size_t rounds, std::vector<Contender>& timed);

/// A whole turn of the loop: such a frame is grabbed from memory and described, then matched with
/// synthetic places; what is matched is synthetic too, so that the robot is recognised.
/// @param ds sequence length
void time_loop(std::size_t places, std::size_t ds, double relocalise_s, std::size_t rounds,
               std::vector<Contender>& timed);

}  // namespace seqloop::program
