// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/fault.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// @return everything that keeps a map of this capacity from being one for a detector with this
/// configuration; what is wrong with the configuration itself is not among it
[[nodiscard]] Faults capacity_faults(const MatcherConfig& config, const Capacity& capacity);

/// The same, and what is wrong with the configuration.
[[nodiscard]] Faults detector_faults(const MatcherConfig& config, const Capacity& capacity);

/// @return everything that keeps a detector with this configuration from working on this map
[[nodiscard]] Faults detector_faults(const MatcherConfig& config, const PlaceMap& map);

}  // namespace seqloop
