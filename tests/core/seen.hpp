// SPDX-License-Identifier: MIT
#pragma once

#include "core/matcher.hpp"
#include "seqloop/detail/place_belief.hpp"

namespace seqloop {

/// What a detector gives its belief to see.
struct Seen {
  MatcherConfig config;
  TestArena memory;
  PlaceMap map;
  QueryHistory queries;
  CandidateProposals proposals;

  Seen(const oracle::Vectors& places, const MatcherConfig& with)
      : config(with),
        map(map_of(places, with)),
        queries(memory.arena, DescriptorForm(with, places.front().size()), 32),
        proposals(memory.arena, with, places.size()) {}

  SceneView take(const std::vector<float>& descriptor) {
    queries.push(descriptor);
    proposals.look(queries, map, map.size(), queries.newest(), 0);
    return {&queries, &map, &proposals, queries.newest(), 0, map.size()};
  }
};

}  // namespace seqloop
