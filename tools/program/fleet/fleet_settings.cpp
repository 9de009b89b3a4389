// SPDX-License-Identifier: MIT
#include "program/fleet/fleet_settings.hpp"

#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string_view>

#include "program/process/utf8.hpp"

namespace seqloop::program {
namespace {

/// @return whether novel places alone are told
bool parse_tell(std::string_view text) {
  if (text == "novel") return true;
  if (text == "all") return false;
  throw std::invalid_argument("'" + std::string(text) + "' is neither all nor novel");
}

}  // namespace

void add_fleet_options(OptionTable& options, FleetSettings& settings) {
  options.section("Map", Shown::in_help_all);
  options.text("fleet", settings.name,
               "tell the robots of this fleet what becomes a place, over DDS, and find loops "
               "with theirs; with --map [alone]");
  options.count("fleet-places", settings.places,
                "room for places of other robots, beside --max-places [20000]");
  options.number("fleet-kbps", settings.kbps,
                 "kilobits of places that are told a second; more waits, and beyond --fleet-places "
                 "the oldest is left out [0: no limit]");
  options.add(
      {"fleet-tell", ValueKind::text,
       "all: each place; novel: those at which this robot was not before, once that is known "
       "[all]",
       [&settings](std::string_view value) { settings.novel = parse_tell(value); }});
  options.text("robot", settings.robot, "this robot's name among others [the machine's]");
}

void check(const FleetSettings& settings, bool map, bool enhance, Faults& faults) {
  if (settings.name.empty()) {
    if (!settings.robot.empty()) faults.push_back({"robot", "there are no others", "--fleet NAME"});
    if (settings.novel) faults.push_back({"fleet-tell", "nothing is told", "--fleet NAME"});
    if (settings.places != FleetSettings{}.places)
      faults.push_back({"fleet-places", "there are no others", "--fleet NAME"});
    if (settings.kbps != 0.0) faults.push_back({"fleet-kbps", "nothing is told", "--fleet NAME"});
    return;
  }
  if (!map)
    faults.push_back({"fleet", "what is told are places of a map that lasts", "add --map FILE"});
  if (enhance) {
    faults.push_back({"fleet, enhance", "differences are enhanced by places that are still to come",
                      "leave one of them out"});
  }
  if (settings.name.find_first_of("*?[") != std::string::npos) {
    faults.push_back({"fleet", "'" + settings.name + "' would be a pattern for other fleets' names",
                      "leave out * ? ["});
  }
  check_name(faults, "robot", settings.robot);
  if (!(settings.kbps >= 0.0)) faults.push_back({"fleet-kbps", "it must be 0 (no limit) or more"});
  if (settings.places == 0 || settings.places > most_fleet_places) {
    faults.push_back({"fleet-places", "it must be 1 to " + std::to_string(most_fleet_places)});
  }
}

std::string robot_name(const FleetSettings& settings) {
  if (!settings.robot.empty()) return settings.robot;
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name.front() == '\0') return "robot";
  return name.data();
}

}  // namespace seqloop::program
