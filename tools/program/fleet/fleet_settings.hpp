// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "program/options/options.hpp"

namespace seqloop::program {

/// Robots that tell each other their places, as the command line puts it.
struct FleetSettings {
  std::string name;             ///< of the fleet; empty: alone
  std::string robot;            ///< name of this one; empty: the machine's
  std::size_t places = 20'000;  ///< room for those of others
  double kbps = 0.0;            ///< kilobits that this one tells a second; 0: all
  bool novel = false;           ///< tells only places at which it closes no loop with its own
};

/// Sessions of others that are known at a time, those that are not heard included.
inline constexpr std::size_t most_fleet_sessions = 1024;

/// Places that there may be room for.
inline constexpr std::size_t most_fleet_places = std::size_t{1} << 20U;

/// @param settings lives as long as the table
void add_fleet_options(OptionTable& options, FleetSettings& settings);

/// Adds a fault for what does not go together. @param map whether there is one that lasts
/// @param enhance whether differences are enhanced by the places around
void check(const FleetSettings& settings, bool map, bool enhance, Faults& faults);

/// The robot's name: as given, or the machine's.
[[nodiscard]] std::string robot_name(const FleetSettings& settings);

}  // namespace seqloop::program
