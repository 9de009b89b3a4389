// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "seqloop/fault.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// Adds a fault where a drive is so short that no frame could ever be answered.
/// @param frames of the query drive
/// @param places that the map has, or has room for
void check_length(Faults& faults, const MatcherConfig& config, std::uint64_t frames,
                  std::uint64_t places);

}  // namespace seqloop::program
