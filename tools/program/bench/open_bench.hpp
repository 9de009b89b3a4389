// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "program/bench/contender.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// A saved map brought into memory, checked, and a plain read of the same file beside it; what the
/// system keeps of the file is dropped before each round. The file is on the disk of TMPDIR.
void time_opening(const Capacity& size, std::size_t rounds, std::vector<Contender>& timed);

}  // namespace seqloop::program
