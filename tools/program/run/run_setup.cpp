// SPDX-License-Identifier: MIT
#include "program/run/run_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "program/drives/camera_decoder.hpp"
#include "program/drives/drive_length.hpp"
#include "program/drives/known_length.hpp"
#include "program/drives/live_camera.hpp"
#include "program/drives/map_builder.hpp"
#include "program/options/verb.hpp"
#include "program/process/interruption.hpp"
#include "program/process/outputs.hpp"
#include "program/run/pictures.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/linux/recording_capture.hpp"
#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::program {
namespace {

/// Sets the rows that the map needs: asked for, or as many as the drive has, or a round number.
/// @param drive that makes the map, of that name; null: a camera
void choose_places(RunSetup& setup, const RunSettings& settings, const FrameSource* drive,
                   const std::filesystem::path& name) {
  constexpr std::size_t unknown_length = 20'000;
  const auto frames = drive == nullptr ? std::nullopt : drive->frame_count();
  setup.places = static_cast<std::size_t>(std::min<std::uint64_t>(
      frames.value_or(unknown_length), std::numeric_limits<std::size_t>::max()));
  if (frames && !known_length(*drive)) {
    // More frames may come than a video declares: they have room where it costs little memory.
    constexpr std::size_t little = 64'000'000;  // bytes, in floating point
    setup.places = std::max(
        setup.places, std::min(unknown_length, little / (setup.descriptor_size * sizeof(float))));
  }
  setup.why_places = {"max-places",
                      frames && *frames >= setup.places
                          ? fmt::format("not given, and {} declares {}: there is room for as "
                                        "many places",
                                        name.string(), counted(*frames, "frame"))
                          : fmt::format("not given: there is room for {} places", setup.places),
                      "--max-places N makes room for fewer"};
  if (settings.max_places == 0) return;
  setup.places = settings.max_places;
  setup.why_places = {"max-places", "room for " + counted(setup.places, "place") + " is asked for"};
}

/// Opens the map that lasts, and makes room for what it holds, too.
void open_map(RunSetup& setup, const RunSettings& settings, const DriveSettings& drive,
              Faults& faults) {
  collect(faults, [&] {
    const bool pictures = setup.describer != nullptr;
    MapSettings of_map = settings.map;
    of_map.waits = !setup.paced;
    setup.map = open_map(of_map, setup.config, setup.descriptor_size,
                         pictures ? fingerprint(drive) : "descriptors", pictures ? jpeg : nullptr);
  });
  if (!setup.map) return;
  const Capacity room = setup.map->capacity(setup.places);
  setup.sessions = room.sessions;
  if (settings.max_places == 0) {
    setup.places = room.places;
    setup.why_places.why += fmt::format(", and for the {} of the map", setup.map->places());
  } else if (setup.map->places() > setup.places) {
    faults.push_back({"max-places",
                      "the map has " + counted(setup.map->places(), "place") + " already",
                      "raise --max-places"});
  }
}

void open_outputs(RunSetup& setup, const RunSettings& settings, Faults& faults) {
  collect(faults, [&] { setup.out = std::make_unique<files::OutputFile>(settings.out); });
  if (!settings.summary.empty()) {
    collect(faults, [&] { setup.summary = std::make_unique<files::OutputFile>(settings.summary); });
  }
  if (settings.pictures.empty()) return;
  check_folder(faults, settings.pictures);
  // What cannot write them is better known now than after the drive.
  collect(faults, [] { static_cast<void>(opencv::file_codecs()); });
  for (const char* name : {matrix_name, sheet_name}) {
    const std::filesystem::path picture = settings.pictures / name;
    std::error_code error;
    if (!std::filesystem::is_directory(picture, error)) continue;
    faults.push_back({picture.string(), "is a folder, and a picture is to have this name",
                      "remove it, or choose another folder for the pictures"});
  }
}

bool is_live(const std::filesystem::path& source) { return is_camera(source) || is_topic(source); }

/// What can be opened twice: before there is a describer, and for it.
void open_recordings(RunSetup& setup, const RunSettings& settings, const DriveSettings& drive,
                     Faults& faults) {
  const Describer* describer = setup.describer.get();
  if (!settings.reference.empty()) {
    collect(faults, [&] {
      setup.reference = open_drive(settings.reference, "reference", drive, describer);
    });
  }
  if (is_live(settings.source)) return;
  if (settings.source.empty()) {
    faults.push_back({"source", "not given",
                      "give a camera, a topic of ROS 2, an image folder, a video, a bag or an .npy "
                      "file"});
    return;
  }
  collect(faults,
          [&] { setup.recording = open_drive(settings.source, "source", drive, describer); });
}

void open_live(RunSetup& setup, const RunSettings& settings, const DriveSettings& drive,
               Clock& clock, Faults& faults) {
  const bool topic = is_topic(settings.source);
  if (!settings.pictures.empty()) {
    faults.push_back({"pictures", "a camera cannot be looked at again",
                      "record the drive and give the recording, or leave --pictures out"});
  }
  // Without a describer there is a fault already, and nothing to choose a mode for.
  if (!setup.describer || (topic && !setup.ros)) return;
  collect(faults, [&] {
    if (topic) {
      LiveTopic opened = open_topic(settings.source, setup.ros, drive.fps, *setup.describer,
                                    settings.real_time, clock);
      setup.live = std::move(opened.source);
      setup.start_ns = std::move(opened.start_ns);
      setup.stamp_ns = std::move(opened.stamp_ns);
      return;
    }
    LiveCamera camera = open_camera(settings.source, settings.camera, drive.fps, *setup.describer,
                                    settings.real_time, clock);
    setup.live = std::move(camera.source);
    setup.capture = std::move(camera.mode);
  });
}

}  // namespace

std::optional<std::uint64_t> RunSetup::frame_count(std::size_t wanted) const noexcept {
  const auto frames = recording ? recording->frame_count() : std::nullopt;
  if (wanted == 0) return frames;
  return std::min<std::uint64_t>(wanted, frames.value_or(wanted));
}

RunSetup set_up(const RunSettings& settings, Faults faults, Clock& clock) {
  RunSetup setup;
  setup.paced = is_live(settings.source) || settings.pace == Pace::live;
  open_outputs(setup, settings, faults);
  const bool lasts = !settings.map.file.empty();
  const bool closing = settings.reference.empty() && !settings.map.read_only;
  check(settings.map, !settings.reference.empty(), faults);
  setup.own_places = settings.reference.empty() && !lasts;
  setup.loops = std::make_unique<LoopOutputs>(settings.loops, closing, faults);
  setup.config = resolve(settings.matcher, closing ? Use::close_loops : Use::localise, faults);
  check(settings.fleet, lasts, setup.config.enhance, faults);
  setup.budget = budget(settings.loop, faults);
  setup.overload = overload_rule(settings.loop, faults);
  prepare(settings.real_time, faults);
  if (!settings.serve.address && !settings.serve.token.empty()) {
    faults.push_back({"serve-token", "nothing is served", "add --serve, or leave it out"});
  }
  if (!(settings.give_up_s >= 0.0)) faults.push_back({"give-up-s", "it must be 0 (never) or more"});
  if (settings.pace == Pace::live && !settings.pictures.empty() && !is_live(settings.source)) {
    faults.push_back({"pictures", "at live pace frames may be missing from them",
                      "leave --pace live or --pictures out"});
  }
  check_camera(settings.camera, settings.source, faults);
  if (settings.give_up_s > 0.0 && !setup.paced) {
    faults.push_back(
        {"give-up-s", "it goes with a camera, and the source is none", "leave it out"});
  }
  check_effects(settings.matcher, setup.config, faults);
  std::vector<std::filesystem::path> drives = settings.drive.training;
  drives.insert(drives.end(), {settings.source, settings.reference});
  check_reading(settings.drive, drives, faults);
  DriveSettings drive = settings.drive;
  drive.difference = setup.config.difference;
  const bool pictures = !is_described(settings.source);
  const bool given = !settings.reference.empty();
  // Learning takes long: what is wrong with the rest is told before.
  const bool learns = !drive.training.empty();
  if (learns) open_recordings(setup, settings, drive, faults);
  if (pictures || (given && !is_described(settings.reference))) {
    suit_descriptor(drive, setup.config.difference, faults);
    setup.describer = open_describer(drive, faults);
  } else {
    refuse_describing(drive, "the drives are described already", faults);
  }
  if (setup.describer || !learns) open_recordings(setup, settings, drive, faults);
  const bool live_odometry = listens_to_odometry(settings.loops, is_live(settings.source));
  std::function<std::vector<ros::OdometryPose>()> odometry;
  if (settings.ros || live_odometry || is_topic(settings.source) || !settings.fleet.name.empty()) {
    collect(faults, [&] {
      setup.ros = join_ros(settings.real_time);
      if (live_odometry) odometry = open_odometry(settings.loops.odometry, setup.ros);
    });
  }
  if (is_live(settings.source)) open_live(setup, settings, drive, clock, faults);
  refuse(faults);

  const auto size_of = [&](const FrameSource* recording) {
    return recording != nullptr ? descriptor_size(*recording, setup.describer.get())
                                : setup.describer->size();
  };
  setup.descriptor_size = size_of(setup.recording.get());
  choose_places(setup, settings, given ? setup.reference.get() : setup.recording.get(),
                given ? settings.reference : settings.source);
  if (lasts) open_map(setup, settings, drive, faults);
  suit_slice(setup.config, settings.matcher, setup.places);
  if (setup.reference && size_of(setup.reference.get()) != setup.descriptor_size) {
    faults.push_back({"reference, source",
                      fmt::format("descriptors of {} and of {} values",
                                  size_of(setup.reference.get()), setup.descriptor_size),
                      "describe both with the same model and layer"});
  }
  if (const auto frames = setup.recording ? known_length(*setup.recording) : std::nullopt) {
    // Into a map that lasts a drive is added that closes no loop, too.
    MatcherConfig config = setup.config;
    if (lasts) config.use = Use::localise;
    check_length(faults, config, *frames, setup.places);
  }
  refuse(std::move(faults));
  if (!setup.start_ns) {
    const std::int64_t start = start_ns(setup.recording.get());
    setup.start_ns = [start] { return start; };
    setup.stamp_ns = [start](double time_s) { return start + std::llround(time_s * 1e9); };
  }
  setup.loops->begin(settings.loops,
                     {settings.source, setup.recording.get(), setup.start_ns, setup.stamp_ns,
                      setup.config.sequence_length + 1, std::move(odometry), setup.map.get()});
  return setup;
}

void start_playing(RunSetup& setup, const RunSettings& settings, Clock& clock) {
  if (setup.live || settings.pace != Pace::live) return;
  setup.live = std::make_unique<live::LiveSource>(
      std::make_unique<live::RecordingCapture>(*setup.recording, clock),
      setup.describer ? std::make_unique<CameraDecoder>(setup.describer->needs()) : nullptr, clock,
      live_settings(settings.real_time));
}

}  // namespace seqloop::program
