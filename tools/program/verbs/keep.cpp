// SPDX-License-Identifier: MIT
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "program/drives/live_topic.hpp"
#include "program/fleet/keeper.hpp"
#include "program/process/interruption.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"

namespace seqloop::program {
namespace {

struct KeepSettings {
  std::filesystem::path map;
  FleetSettings fleet;
  double save_every_s = 1.0;
};

void keep(const KeepSettings& settings, Faults faults) {
  take_interruptions();
  if (settings.map.empty()) {
    faults.push_back({"map", "there is none", "--map FILE"});
  } else if (const auto folder = std::filesystem::absolute(settings.map).parent_path();
             !std::filesystem::is_directory(folder)) {
    // Told by then, a fleet's places would wait for it to the end.
    faults.push_back({"map", folder.string() + " is no folder", "make it, or name another file"});
  }
  if (settings.fleet.name.empty()) faults.push_back({"fleet", "there is none", "--fleet NAME"});
  check(settings.fleet, true, false, faults);
  if (!(settings.save_every_s > 0.0 && settings.save_every_s <= 3600.0)) {
    faults.push_back({"save-every-s", "it must be above 0 and at most 3600"});
  }
  refuse(std::move(faults));
  const auto participant = join_ros({});
  Keeper keeper(settings.map, settings.fleet, *participant, settings.save_every_s);
  say("fleet '{}': what its robots tell is kept in {}", settings.fleet.name, settings.map.string());
  while (!interrupted()) {
    keeper.round(interrupted);
    for (const std::string& line : keeper.news()) say("{}", line);
  }
  const std::string kept = keeper.end();
  for (const std::string& line : keeper.news()) say("{}", line);
  say("{}: {}", settings.map.string(), kept);
  if (const std::string unsaved = keeper.unsaved(); !unsaved.empty())
    throw std::runtime_error(unsaved);
}

}  // namespace

Verb keep_verb() {
  const auto settings = std::make_shared<KeepSettings>();
  Verb verb{"keep",
            "Keep what all robots of a fleet tell each other in one map, for those that come later",
            {},
            [settings](Faults faults) { keep(*settings, std::move(faults)); }};
  verb.options.section("Map");
  verb.options.path("map", Access::writes, settings->map,
                    "map that lasts, with a session for each of theirs; made where it is missing");
  verb.options.text("fleet", settings->fleet.name, "the fleet's name");
  verb.options.count("fleet-places", settings->fleet.places,
                     "places of each session that DDS keeps in memory for who comes late [20000]");
  verb.options.text("robot", settings->fleet.robot,
                    "whose drives the map's own sessions are [the machine's name]");
  verb.options.number("save-every-s", settings->save_every_s,
                      "seconds after which what was told is saved [1]");
  return verb;
}

}  // namespace seqloop::program
