// SPDX-License-Identifier: MIT
#include "seqloop/detail/detector_faults.hpp"

#include <string>
#include <utility>

namespace seqloop {

Faults capacity_faults(const MatcherConfig& config, const Capacity& capacity) {
  Faults faults = validate(capacity, config);
  if (config.use == Use::close_loops && config.full_map != FullMap::refuse &&
      capacity.places < least_places(config)) {
    faults.push_back({"places",
                      std::to_string(capacity.places) + " leave no candidates once the map is full",
                      "take " + std::to_string(least_places(config)) +
                          " or more with this exclude and sequence_length"});
  }
  return faults;
}

Faults detector_faults(const MatcherConfig& config, const Capacity& capacity) {
  Faults faults = validate(config);
  for (Fault& fault : capacity_faults(config, capacity)) faults.push_back(std::move(fault));
  return faults;
}

Faults detector_faults(const MatcherConfig& config, const PlaceMap& map) {
  Faults faults =
      detector_faults(config, {map.capacity(), map.descriptor_size(), map.order().most_sessions()});
  // Where there is room for several sessions, they may be taken in later.
  if (config.use == Use::localise && map.size() == 0 && map.order().most_sessions() == 1) {
    faults.push_back({"map", "it has no places",
                      "add the reference drive before localising in it, or let it close loops "
                      "(close_loops)"});
  }
  if (config.use == Use::close_loops && !map.has_room_for_session()) {
    faults.push_back(
        {"sessions",
         "the map has no room for one more than its " + std::to_string(map.order().sessions()),
         "give it room for the drive that is added, too"});
  }
  if (map.rows().form() != DescriptorForm(config, map.descriptor_size()) ||
      map.full_map() != config.full_map ||
      map.knows_visits() != (config.decision == Decision::probability)) {
    faults.push_back(
        {"map", "it was made for another configuration",
         "give both the same arithmetic, difference, candidates, relocalising, decision "
         "and full_map"});
  }
  if (map.standardises() != config.standardisation.on) {
    faults.push_back(
        {"map",
         map.standardises() ? "its places are standardised" : "its places are not standardised",
         "standardise both the map and the query, or neither; a map that is filled before its "
         "detector is there has to be made to localise in (localise)"});
  }
  return faults;
}

}  // namespace seqloop
