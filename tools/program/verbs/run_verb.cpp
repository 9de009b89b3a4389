// SPDX-License-Identifier: MIT
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "program/process/database_file.hpp"
#include "program/run/pictures.hpp"
#include "program/verbs/all_verbs.hpp"
#include "program/verbs/run.hpp"
#include "seqloop/bags/bag.hpp"

namespace seqloop::program {
namespace {

Pace parse_pace(std::string_view text) {
  if (text == "max") return Pace::max;
  if (text == "live") return Pace::live;
  throw std::invalid_argument("'" + std::string(text) + "' is neither live nor max");
}

/// A map that was saved is a reference, too: the drive is localised in it, and it stays as it is.
void take_map_for_reference(RunSettings& settings) {
  const bool is_map = is_database(settings.reference) && !bags::is_bag(settings.reference);
  if (!is_map || !settings.map.file.empty()) return;
  settings.map.file = std::exchange(settings.reference, {});
  settings.map.read_only = true;
}

constexpr std::string_view tasks =
    R"(Tasks, and what is taken by default:
  close loops       --source DRIVE                  room for as many places as DRIVE has frames; the
                                                    newest 20 frames are no places (--exclude)
  localise          --source DRIVE --reference MAP  a place for each frame of MAP, a drive; or the
                                                    places of a map that was saved
  a map that lasts  --source DRIVE --map FILE       both: in all that FILE has, and in DRIVE, which
                                                    is added to it while it runs
  run on a camera   --source /dev/video0            room for 20000 places; the cheapest mode of 10
                                                    frames a second or more; late frames dropped
  time a recording  --source DRIVE --pace live      10 frames a second of a folder; late frames
                                                    dropped; histograms with --summary FILE
  follow the paper  --paper                         --standardise off --relocalise off
                                                    --arithmetic float
  as SeqSLAM does   --method seqslam                --descriptor patches --enhance on
                                                    --difference mean-absolute --standardise off
                                                    --arithmetic float)";

}  // namespace

Verb run_verb() {
  const auto settings = std::make_shared<RunSettings>();
  Verb verb{"run",
            "Grab, describe, match and decide, frame by frame",
            {},
            [settings](Faults faults) {
              take_map_for_reference(*settings);
              run(*settings, std::move(faults));
            },
            std::string(tasks)};
  verb.options.section("Task");
  verb.options.path("source", Access::reads, settings->source,
                    "camera (/dev/video0), topic of ROS 2 (ros:/camera), image folder, video file, "
                    "bag (.mcap, .db3, its folder) or descriptors (.npy)");
  verb.options.path("reference", Access::reads, settings->reference,
                    "drive, or saved map, to localise in [close loops within the source]");
  verb.options.path("out", Access::writes, settings->out,
                    "one JSON object a frame [standard output]");
  verb.options.path("summary", Access::writes, settings->summary,
                    "counts and latency histograms of the run, as JSON [none]");
  verb.options.folder("pictures", settings->pictures, {matrix_name, sheet_name},
                      "folder for the difference matrix and a sheet of matched pairs [none]");
  add_loop_output_options(verb.options, settings->loops);
  verb.options.section("Task");
  verb.options.flag("ros", settings->ros,
                    "publish to ROS 2: /seqloop/loop_closures, /seqloop/status, /diagnostics");
  verb.options.section("Source");
  verb.options.add({"pace", ValueKind::text,
                    "live: a recording at its own rate, as a camera would deliver it; max: as fast "
                    "as it goes [max]",
                    [settings](std::string_view value) { settings->pace = parse_pace(value); }});
  verb.options.count("frames", settings->frames, "stop after this many frames [0: all]");
  add_map_options(verb.options, settings->map);
  add_thumbnail_option(verb.options, settings->map);
  add_fleet_options(verb.options, settings->fleet);
  verb.options.section("Source");
  add_drive_options(verb.options, settings->drive);
  add_matcher_options(verb.options, settings->matcher);
  verb.options.section("Matching");
  verb.options.count("max-places", settings->max_places,
                     "room in the map [0: as long as the drive, 20000 where that is not known]");
  add_loop_options(verb.options, settings->loop);
  add_camera_options(verb.options, settings->camera);
  verb.options.number("give-up-s", settings->give_up_s,
                      "seconds without a frame after which a camera is given up [0: never]");
  add_real_time_options(verb.options, settings->real_time);
  add_serve_options(verb.options, settings->serve);
  return verb;
}

}  // namespace seqloop::program
