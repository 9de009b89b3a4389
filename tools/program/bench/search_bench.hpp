// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "program/bench/contender.hpp"

namespace seqloop::program {

/// The scores of all rows at one frame, in differences that are there already: by whole numbers, by
/// float, and by plain code that adds up every line from end to end, in float, for many rows at
/// once.
/// @param ds sequence length
void time_search(std::size_t places, std::size_t ds, std::size_t rounds,
                 std::vector<Contender>& timed);

}  // namespace seqloop::program
