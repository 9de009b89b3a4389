// SPDX-License-Identifier: MIT
#include <memory>
#include <utility>
#include <vector>

#include "program/drives/describe_drive.hpp"
#include "program/drives/drives.hpp"
#include "program/drives/live_camera.hpp"
#include "program/drives/live_topic.hpp"
#include "program/process/interruption.hpp"
#include "program/process/progress.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/linux/steady_clock.hpp"

namespace seqloop::program {
namespace {

struct DescribeSettings {
  std::filesystem::path source;
  std::filesystem::path out;
  std::size_t frames = 0;  ///< 0: all
  DriveSettings drive;
  CameraSettings camera;
};

void describe(const DescribeSettings& settings, Faults faults) {
  take_interruptions();
  live::SteadyClock clock;
  const bool topic = is_topic(settings.source);
  const bool live = topic || is_camera(settings.source);
  std::unique_ptr<Describer> describer;
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<files::NpyWriter> out;
  if (settings.source.empty()) {
    faults.push_back({"source", "not given", "give an image folder, a video, a bag or a camera"});
  } else if (is_described(settings.source)) {
    faults.push_back({"source", settings.source.string() + " holds descriptors already",
                      "give an image folder or a video"});
  }
  check_camera(settings.camera, settings.source, faults);
  std::vector<std::filesystem::path> drives = settings.drive.training;
  drives.push_back(settings.source);
  check_reading(settings.drive, drives, faults);
  if (settings.out.empty()) faults.push_back({"out", "not given", "--out D.npy"});
  const auto open = [&] {
    if (!live && !settings.source.empty() && !is_described(settings.source)) {
      collect(faults, [&] {
        source = open_drive(settings.source, "source", settings.drive, describer.get());
      });
    }
    const std::size_t size = describer ? describer->size() : 1;
    if (settings.out.empty()) return;
    collect(faults, [&] { out = std::make_unique<files::NpyWriter>(settings.out, size); });
  };
  // Learning takes long: what is wrong with the rest is told before.
  const bool learns = !settings.drive.training.empty();
  if (learns) open();
  describer = open_describer(settings.drive, faults);
  if (describer || !learns) open();
  refuse(std::move(faults));
  if (topic) {
    source =
        open_topic(settings.source, join_ros({}), settings.drive.fps, *describer, {}, clock).source;
  } else if (live) {
    LiveCamera opened =
        open_camera(settings.source, settings.camera, settings.drive.fps, *describer, {}, clock);
    say("{}: {}", settings.source.string(), opened.mode);
    source = std::move(opened.source);
  }

  Progress progress("describing", source->frame_count());
  const DescribedCount count = describe_drive(
      settings.source.string(), *source, *describer,
      [&out](std::span<const float> row) { out->append(row); }, progress, {settings.frames, live});
  out->commit();
  say("{} of {} in {}", counted(count.rows, "frame"), counted(describer->size(), "value"),
      settings.out.string());
  if (count.unreadable > 0) say("rows of zeros: {}", counted(count.unreadable, "unreadable frame"));
  if (count.missing > 0) {
    say("rows of zeros: {} lost or dropped", counted(count.missing, "frame"));
  }
  if (count.blank > 0) {
    say("{} {} blank, without any feature", counted(count.blank, "frame"), are(count.blank));
  }
}

}  // namespace

Verb describe_verb() {
  const auto settings = std::make_shared<DescribeSettings>();
  Verb verb{
      "describe", "Write the descriptors of every frame of a drive", {}, [settings](Faults faults) {
        describe(*settings, std::move(faults));
      }};
  verb.options.section("Task");
  verb.options.path(
      "source", Access::reads, settings->source,
      "camera (/dev/video0) or topic of ROS 2 (ros:/camera), until interrupted; image "
      "folder, video file or bag");
  verb.options.path("out", Access::writes, settings->out,
                    "descriptors: float32 [N, D], .npy; unit L2, but patches 0..255");
  verb.options.count("frames", settings->frames, "stop after this many frames [0: all]");
  add_drive_options(verb.options, settings->drive);
  add_camera_options(verb.options, settings->camera);
  return verb;
}

}  // namespace seqloop::program
