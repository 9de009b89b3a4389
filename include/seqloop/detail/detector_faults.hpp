// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/fault.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// @return everything that keeps a detector with this configuration from working, whatever map of
/// this capacity it is given
[[nodiscard]] Faults detector_faults(const MatcherConfig& config, const Capacity& capacity);

/// @return everything that keeps a detector with this configuration from working on this map
[[nodiscard]] Faults detector_faults(const MatcherConfig& config, const PlaceMap& map);

}  // namespace seqloop
