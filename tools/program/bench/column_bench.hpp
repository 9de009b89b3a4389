// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "program/bench/contender.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// What a peer takes the distances between.
struct ColumnData {
  Capacity size;
  std::span<const float> query;  ///< [D] of length 1
  std::span<const float> rows;   ///< [N, padded_size(D)] of length 1, zero beyond D
  bool graph;  ///< whether a graph of nearest neighbours may be built, which takes long
};

/// Makes contenders of other libraries; what they hold of the data may be views.
using PeerColumns = std::function<std::vector<Contender>(const ColumnData&)>;

/// A column of distances: int8 by every variant that this processor has (the one in use first),
/// sketches, float, the peers, and how long it takes just to read the rows in int8 and in float.
/// Rows are read again and again: from the cache that they fit, if they fit one.
/// What does not fit the memory that is available is left out, and it is said.
/// @param graph_places places up to which peers may build graphs
void time_columns(const Capacity& size, std::size_t graph_places, const PeerColumns& peers,
                  std::size_t rounds, std::vector<Contender>& timed);

}  // namespace seqloop::program
