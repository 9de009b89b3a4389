// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "program/options/matcher_settings.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::program {
namespace {

struct PlanSettings {
  MatcherSettings matcher;
  std::size_t places = 3476;
  std::size_t descriptor_size = 735;
  bool close_loops = false;
};

void print_buffers(const char* owner, const std::vector<BufferSize>& buffers) {
  for (const BufferSize& buffer : buffers) {
    if (buffer.bytes > 0) fmt::print("{:>16}  {}: {}\n", buffer.bytes, owner, buffer.name);
  }
}

void plan(const PlanSettings& settings, Faults faults) {
  MatcherConfig config =
      resolve(settings.matcher, settings.close_loops ? Use::close_loops : Use::localise, faults);
  suit_slice(config, settings.matcher, settings.places);
  const Capacity capacity{settings.places, settings.descriptor_size};
  for (Fault& fault : validate(capacity, config)) faults.push_back(std::move(fault));
  refuse(std::move(faults));

  const std::vector<BufferSize> map = PlaceMap::plan(config, capacity);
  const std::vector<BufferSize> detector = Detector::plan(config, capacity);
  const Work most = Detector::most_work(config, capacity);
  fmt::print("{}, ds {}, {} places of {} values, {}\n\n", settings.matcher.method,
             config.sequence_length, capacity.places, capacity.descriptor_size,
             settings.close_loops ? "closing loops" : "localising");
  fmt::print("           bytes  buffer\n");
  print_buffers("map", map);
  print_buffers("detector", detector);
  const std::uint64_t total = total_bytes(map) + total_bytes(detector);
  fmt::print("{:>16}  in all ({:.1f} MiB)\n\n", total, static_cast<double>(total) / 1048576.0);
  fmt::print("            most  that one frame can cost\n");
  fmt::print("{:>16}  descriptor distances, {} values each\n", most.distances,
             capacity.descriptor_size);
  fmt::print("{:>16}  line sums, of {} differences each\n", most.line_sums,
             config.sequence_length + 1);
  if (!relocalises(config)) return;
  fmt::print("{:>16}  places looked at by 32 bytes of their sketches\n", most.scanned);
  fmt::print("{:>16}  pairs of sketches, 128 bytes each\n", most.sketches);
  fmt::print(
      "{:>16}  frames until the whole map was looked at\n",
      (capacity.places + config.relocalising.rows_scanned - 1) / config.relocalising.rows_scanned);
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
  verb.options.flag("close-loops", settings->close_loops,
                    "the map is the drive itself [localise in a fixed map]");
  add_matcher_options(verb.options, settings->matcher);
  return verb;
}

}  // namespace seqloop::program
