// SPDX-License-Identifier: MIT
// Which frames show the same place.
#pragma once

#include <cstddef>
#include <vector>

#include "drive.hpp"

namespace seqloop::street {

constexpr std::size_t kLoopAge = 100;  ///< frames; a loop's earlier visit is older than this

struct TruthRow {
  std::size_t query, reference;  ///< frame numbers
};

/// One row for each query frame: the reference frame nearest along the street; of several equally
/// near ones, taken at a halt, the middle one. Both drives have one leg over the same street.
std::vector<TruthRow> localise_truth(const Drive& query, const Drive& reference);

/// For each frame that revisits a place: the nearest frame of each earlier visit older than
/// kLoopAge frames. In order of query, then of reference.
std::vector<TruthRow> loop_truth(const Drive& drive);

/// The legs of a drive that closes loops: a new stretch, then by turns old and new ones. Below 260
/// frames, or metres, only the new stretch.
/// @param frames 1 or more. @param length metres, all legs together.
/// @param kidnaps how many visits begin without a road that leads there, as far as they fit.
std::vector<Leg> loop_legs(const Street& street, std::size_t frames, double length,
                           std::size_t kidnaps);

/// @return how many legs begin with a jump of the camera.
std::size_t count_kidnaps(const std::vector<Leg>& legs);

}  // namespace seqloop::street
