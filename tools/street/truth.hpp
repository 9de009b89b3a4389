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

/// Earlier frames first..last were taken near frame `query`, on another road.
struct NearRow {
  std::size_t query, first, last;  ///< frame numbers
};

/// Roads that meet run side by side before they do: what a camera passes there it has passed before
/// as far as its position tells, though on another road. For each frame within 100 m of a junction:
/// the frames older than kLoopAge, on roads through the same junction, that were taken within
/// `metres` of it and face the same way to 45 degrees. Positions are those of the centre line. In
/// order of query, then of first.
/// Work: junctions x visits of each x the frames of 200 m squared.
std::vector<NearRow> near_truth(const Drive& drive, double metres);

/// The legs of a drive that closes loops: a new stretch, then by turns old and new ones. Below 260
/// frames, or metres, only the new stretch.
/// @param frames 1 or more. @param length metres, all legs together.
/// @param kidnaps how many visits begin without a road that leads there, as far as they fit.
std::vector<Leg> loop_legs(const Street& street, std::size_t frames, double length,
                           std::size_t kidnaps);

/// @return how many legs begin with a jump of the camera.
std::size_t count_kidnaps(const std::vector<Leg>& legs);

}  // namespace seqloop::street
