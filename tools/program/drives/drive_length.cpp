// SPDX-License-Identifier: MIT
#include "program/drives/drive_length.hpp"

#include <fmt/format.h>

#include "seqloop/detail/counted.hpp"
#include "seqloop/detail/trajectories.hpp"

namespace seqloop::program {

void check_length(Faults& faults, const MatcherConfig& config, std::uint64_t frames,
                  std::uint64_t places) {
  const std::size_t ds = config.sequence_length;
  if (frames < ds + 1) {
    faults.push_back({"ds",
                      fmt::format("a window of {} is longer than the drive, {}",
                                  counted(ds + 1, "frame"), counted(frames, "frame")),
                      "shorten ds"});
    return;
  }
  // The slowest line needs the fewest rows.
  const std::int64_t m = velocity_range(ds, config.vmin, config.vmax).first;
  const auto rows =
      static_cast<std::uint64_t>(trajectory_offset(m, ds, ds) - trajectory_offset(m, 0, ds) + 1);
  if (places < rows) {
    faults.push_back(
        {"ds",
         fmt::format("the shortest line spans {}, the map has {}", counted(rows, "place"), places),
         "shorten ds"});
  }
  const std::uint64_t last_centre = frames - 1 - (ds - ds / 2);
  if (config.use == Use::close_loops && last_centre < config.exclude + rows) {
    faults.push_back(
        {"exclude",
         fmt::format("without its newest {} a drive of {} leaves no room for a line of {}",
                     counted(config.exclude, "frame"), frames, counted(rows, "place")),
         "lower exclude or ds"});
  }
}

}  // namespace seqloop::program
