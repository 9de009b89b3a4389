// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "program/fleet/fleet_settings.hpp"
#include "program/fleet/others_map.hpp"
#include "program/fleet/through_own.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/detail/detector_faults.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::program {
namespace {

struct PlanSettings {
  MatcherSettings matcher;
  std::size_t places = 3476;
  std::size_t descriptor_size = 735;
  std::size_t fleet_places = 0;
  bool close_loops = false;
};

void print_buffers(const char* owner, const std::vector<BufferSize>& buffers) {
  for (const BufferSize& buffer : buffers) {
    if (buffer.bytes > 0) fmt::print("{:>16}  {}: {}\n", buffer.bytes, owner, buffer.name);
  }
}

void print_work(const MatcherConfig& config, const Capacity& capacity) {
  const Work most = Detector::most_work(config, capacity);
  fmt::print("{:>16}  descriptor distances, {} values each\n", most.distances,
             capacity.descriptor_size);
  fmt::print("{:>16}  line sums, of {} differences each\n", most.line_sums,
             config.sequence_length + 1);
  if (most.sketches == 0) return;
  if (most.scanned > 0)
    fmt::print("{:>16}  places looked at by 32 bytes of their sketches\n", most.scanned);
  fmt::print("{:>16}  pairs of sketches, 128 bytes each\n", most.sketches);
  if (!relocalises(config)) return;
  fmt::print(
      "{:>16}  frames until the whole map was looked at\n",
      (capacity.places + config.relocalising.rows_scanned - 1) / config.relocalising.rows_scanned);
}

/// What places of other robots take, beside the run's own.
struct OthersPlan {
  MatcherConfig config;
  Capacity capacity;
  std::vector<BufferSize> map;
  std::vector<BufferSize> detector;
  std::vector<BufferSize> more;
};

OthersPlan plan_others(const PlanSettings& settings, MatcherConfig config, const Capacity& own) {
  suit_slice(config, settings.matcher, settings.fleet_places);
  config = OthersMap::suited(config);
  const Capacity capacity{settings.fleet_places, settings.descriptor_size, most_fleet_sessions};
  std::vector<BufferSize> more = OthersMap::plan(capacity);
  for (const BufferSize& buffer : ThroughOwn::plan(own)) more.push_back(buffer);
  return {config, capacity, PlaceMap::plan(config, capacity), Detector::plan(config, capacity),
          std::move(more)};
}

void plan(const PlanSettings& settings, Faults faults) {
  MatcherConfig config =
      resolve(settings.matcher, settings.close_loops ? Use::close_loops : Use::localise, faults);
  check_effects(settings.matcher, config, faults);
  suit_slice(config, settings.matcher, settings.places);
  const Capacity capacity{settings.places, settings.descriptor_size};
  for (Fault& fault : capacity_faults(config, capacity)) faults.push_back(std::move(fault));
  if (settings.fleet_places > most_fleet_places) {
    faults.push_back({"fleet-places", fmt::format("at most {}", most_fleet_places)});
  }
  refuse(std::move(faults));

  const std::vector<BufferSize> map = PlaceMap::plan(config, capacity);
  const std::vector<BufferSize> detector = Detector::plan(config, capacity);
  std::optional<OthersPlan> others;
  if (settings.fleet_places > 0) others = plan_others(settings, config, capacity);
  fmt::print("{}, ds {}, {} of {}, {}\n\n", settings.matcher.method, config.sequence_length,
             counted(capacity.places, "place"), counted(capacity.descriptor_size, "value"),
             settings.close_loops ? "closing loops" : "localising");
  fmt::print("           bytes  buffer\n");
  print_buffers("map", map);
  print_buffers("detector", detector);
  std::uint64_t total = total_bytes(map) + total_bytes(detector);
  if (others) {
    print_buffers("others' map", others->map);
    print_buffers("others' detector", others->detector);
    print_buffers("others", others->more);
    total += total_bytes(others->map) + total_bytes(others->detector) + total_bytes(others->more);
  }
  fmt::print("{:>16}  in all ({:.1f} MiB)\n\n", total, static_cast<double>(total) / 1048576.0);
  fmt::print("            most  that one frame can cost\n");
  print_work(config, capacity);
  if (!others) return;
  fmt::print("\n            most  among {} places of other robots, in addition\n",
             settings.fleet_places);
  print_work(others->config, others->capacity);
  fmt::print(
      "\nBeside all that, DDS keeps what this robot has told, and what it has not handed on "
      "yet.\n");
}

}  // namespace

Verb plan_verb() {
  const auto settings = std::make_shared<PlanSettings>();
  Verb verb{"plan",
            "Print the memory and the work that a configuration takes, without starting it",
            {},
            [settings](Faults faults) { plan(*settings, std::move(faults)); }};
  verb.options.section("Task");
  verb.options.count("max-places", settings->places, "places of the map [3476]");
  verb.options.count("descriptor-size", settings->descriptor_size,
                     "values in a descriptor [735, the built-in one]");
  verb.options.count("fleet-places", settings->fleet_places,
                     "room for places of other robots, as `run --fleet` has it [0: alone]");
  verb.options.flag("close-loops", settings->close_loops,
                    "the map is the drive itself [localise in a fixed map]");
  add_matcher_options(verb.options, settings->matcher);
  return verb;
}

}  // namespace seqloop::program
