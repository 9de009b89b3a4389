// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "program/drives/drives.hpp"
#include "program/drives/live_topic.hpp"
#include "program/fleet/fleet_settings.hpp"
#include "program/map/lasting_map.hpp"
#include "program/options/camera_options.hpp"
#include "program/options/loop_options.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/options/real_time_options.hpp"
#include "program/run/loop_outputs.hpp"
#include "program/watch/serving.hpp"
#include "seqloop/budget.hpp"
#include "seqloop/files/output_file.hpp"
#include "seqloop/linux/live_source.hpp"

namespace seqloop::program {

/// How a recording is played.
enum class Pace : std::uint8_t {
  max,  ///< a frame as soon as the one before is done
  live  ///< as a camera would: no frame before its time, and late ones are dropped for newer ones
};

struct RunSettings {
  std::filesystem::path source;
  std::filesystem::path reference;
  std::filesystem::path out = "-";
  std::filesystem::path pictures;
  std::filesystem::path summary;
  LoopOutputSettings loops;
  Pace pace = Pace::max;
  std::size_t frames = 0;      ///< 0: all
  std::size_t max_places = 0;  ///< 0: as many as the drive has
  double give_up_s = 0.0;      ///< 0: never
  MapSettings map;
  FleetSettings fleet;
  DriveSettings drive;
  CameraSettings camera;
  MatcherSettings matcher;
  LoopSettings loop;
  RealTimeSettings real_time;
  ServeSettings serve;
  bool ros = false;  ///< whether answers are published
};

/// Everything that a run needs, opened and checked.
struct RunSetup {
  MatcherConfig config;
  Budget budget;
  OverloadRule overload;
  std::unique_ptr<Describer> describer;    ///< none when nothing has to be described
  std::shared_ptr<dds::Participant> ros;   ///< none unless something of ROS 2 is asked for
  std::unique_ptr<FrameSource> recording;  ///< none when the source is a camera or a topic
  std::unique_ptr<live::LiveSource> live;  ///< a camera, or the recording at its own pace
  bool paced = false;                      ///< frames come at their own time, not when asked for
  std::string capture;                     ///< the camera and its mode; empty for others
  /// When the drive's second 0 was, in nanoseconds since 1970; of a topic, once a frame has come.
  /// Where its clock was set back, by the clock as it is now.
  std::function<std::int64_t()> start_ns;
  StampAt stamp_ns;
  std::unique_ptr<FrameSource> reference;  ///< none when loops are closed
  std::unique_ptr<LastingMap> map;         ///< none unless asked for
  std::unique_ptr<files::OutputFile> out;
  std::unique_ptr<files::OutputFile> summary;  ///< none unless asked for
  std::unique_ptr<LoopOutputs> loops;
  std::size_t descriptor_size = 0;
  std::size_t places = 0;
  std::size_t sessions = 1;
  bool own_places = false;  ///< places are frames of this drive, and go by their numbers
  Fault why_places;         ///< who wants so many; a fault only where they cannot be had

  [[nodiscard]] Capacity capacity() const noexcept { return {places, descriptor_size, sessions}; }

  /// Where frames come from.
  [[nodiscard]] FrameSource& source() const noexcept {
    return live ? static_cast<FrameSource&>(*live) : *recording;
  }

  /// Frames that will come, where that is known.
  [[nodiscard]] std::optional<std::uint64_t> frame_count(std::size_t wanted) const noexcept;
};

/// Opens everything; a camera delivers from here on. Throws SetupError with all faults at once.
/// @param clock lives as long as the setup
[[nodiscard]] RunSetup set_up(const RunSettings& settings, Faults faults, Clock& clock);

/// Begins to play a recording at its own pace, where that is asked for.
void start_playing(RunSetup& setup, const RunSettings& settings, Clock& clock);

}  // namespace seqloop::program
