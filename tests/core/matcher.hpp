// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/oracle.hpp"
#include "seqloop/detector.hpp"

namespace seqloop {

/// Heap-backed arena for a component under test.
struct TestArena {
  ArenaMemory memory{std::size_t{1} << 24U, {}};
  Arena arena{memory.span()};
};

/// A configuration that the paper's letter asks for.
inline MatcherConfig paper(Candidates candidates, std::size_t ds, Use use = Use::localise) {
  MatcherConfig config;
  config.candidates = candidates;
  config.use = use;
  config.sequence_length = ds;
  config.arithmetic = Arithmetic::float32;
  config.relocalising.on = false;
  config.standardisation.on = false;
  config.blank_is_unreadable = false;
  config.decision = Decision::uniqueness;
  config.max_uniqueness = 1.0F;
  return config;
}

/// @param earlier so many of the places are a session of their own, if there are any
inline void fill(PlaceMap& map, const oracle::Vectors& places, std::size_t earlier = 0) {
  for (const auto& place : places) static_cast<void>(map.learn(place));
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_TRUE(map.add(places[i]));
    if (i + 1 == earlier) {
      EXPECT_TRUE(map.begin_session());
    }
  }
}

/// A map that holds a whole drive: as it came, unless the configuration standardises.
inline PlaceMap map_of(const oracle::Vectors& places, const MatcherConfig& config) {
  PlaceMap map(config, {places.size(), places.front().size()});
  fill(map, places);
  return map;
}

/// Every report of a drive. @param reference empty: close loops within the query.
inline std::vector<FrameReport> reports(const oracle::Vectors& reference,
                                        const oracle::Vectors& query, const MatcherConfig& config) {
  PlaceMap map = reference.empty() ? PlaceMap(config, {query.size(), query.front().size()})
                                   : map_of(reference, config);
  Detector detector(config, map);
  std::vector<FrameReport> all;
  for (const auto& descriptor : query) all.push_back(detector.step(descriptor));
  return all;
}

}  // namespace seqloop
