// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "seqloop/detail/detector_faults.hpp"
#include "seqloop/detector.hpp"

namespace seqloop {

namespace {

void refuse_faults(const MatcherConfig& config, const Capacity& capacity) {
  Faults faults = detector_faults(config, capacity);
  if (!faults.empty()) throw SetupError(std::move(faults));
}

}  // namespace

std::vector<BufferSize> Detector::plan(const MatcherConfig& config, const Capacity& capacity) {
  refuse_faults(config, capacity);
  std::vector<BufferSize> buffers;
  const Detector measured(Arena(buffers), config, nullptr, capacity, ArenaMemory());
  return buffers;
}

Work Detector::most_work(const MatcherConfig& config, const Capacity& capacity) {
  refuse_faults(config, capacity);
  const std::size_t window = config.sequence_length + 1;
  const std::uint64_t lines =
      velocity_range(config.sequence_length, config.vmin, config.vmax).count();
  const std::size_t change = config.candidates == Candidates::adaptive ? ChangeDegree::reach : 0;
  CandidateProposals::Looks looks{0, 0};
  if (scans(config)) looks = CandidateProposals::most_looks(config, capacity.places);
  if (config.decision == Decision::probability) looks.closely += PlaceBelief::most_sketches;
  if (relocalises(config)) {
    const std::size_t moved = moves_frames(config) ? SidewaysShift::distances : 0;
    const std::size_t rows = std::min(CandidateBudget::most_rows(config), capacity.places);
    return {rows, distances_a_frame(config) + change + moved, rows * lines, looks.scanned,
            looks.closely};
  }
  // Where all rows are candidates, a column is computed as its frame arrives. In a growing map, a
  // column that repeats another (`skip`) has as many rows more to look at as it is younger, and
  // columns that reach the newest places grow with them. Elsewhere a full search finds the whole
  // window empty.
  std::uint64_t distances = capacity.places;
  if (config.candidates != Candidates::all) {
    distances *= window;
  } else if (config.use == Use::close_loops) {
    const std::size_t ds = config.sequence_length;
    const std::size_t reach = ds / 2 + (config.enhance ? config.rwindow / 2 : 0);
    const std::size_t growing = reach - std::min(reach, config.exclude);
    distances += ds * (ds + 1) / 2 + (ds + growing) * growing;
  }
  return {capacity.places, distances + change, capacity.places * lines, looks.scanned,
          looks.closely};
}

}  // namespace seqloop
