// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "program/bench/contender.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// A drive to match with a map of as many places, as floats for peers.
struct MatrixData {
  Capacity size;
  std::span<const float> queries;  ///< [N, padded_size(D)] of length 1, zero beyond D
  std::span<const float> rows;     ///< the same
};

using PeerMatrices = std::function<std::vector<Contender>(const MatrixData&)>;

/// A whole recorded drive matched with a map: all differences, and the best line through every row
/// at every frame. A round is the whole drive.
/// @param ds sequence length
void time_matrix(const Capacity& size, std::size_t ds, const PeerMatrices& peers,
                 std::size_t rounds, std::vector<Contender>& timed);

}  // namespace seqloop::program
