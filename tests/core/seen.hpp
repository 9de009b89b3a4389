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

  /// @param earlier so many of the places are an earlier drive's
  Seen(const oracle::Vectors& places, const MatcherConfig& with, std::size_t earlier = 0)
      : config(with),
        map(with, {places.size(), places.front().size(), earlier > 0 ? 2U : 1U}),
        queries(memory.arena, DescriptorForm(with, places.front().size()), 32),
        proposals(memory.arena, with, places.size()) {
    fill(map, places, earlier);
  }

  SceneView take(const std::vector<float>& descriptor) {
    queries.push(descriptor);
    proposals.look(queries, map, map.size(), queries.newest(), 0);
    return {&queries, &map, &proposals, queries.newest(), 0, map.size()};
  }
};

}  // namespace seqloop
