// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <atomic>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "program/options/camera_options.hpp"
#include "program/process/interruption.hpp"
#include "program/process/progress.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"
#include "program/verbs/camera_report.hpp"
#include "seqloop/linux/camera.hpp"
#include "seqloop/linux/camera_list.hpp"
#include "seqloop/linux/steady_clock.hpp"

namespace seqloop::program {
namespace {

// What the built-in descriptor takes in: the mode is the one that `run` would take.
constexpr PictureNeeds built_in{.width = 128, .height = 64, .gray_is_enough = true};
constexpr Nanoseconds patience = std::chrono::seconds(10);

struct CameraVerbSettings {
  std::string device;
  std::optional<std::size_t> frames;
  double fps = 10.0;
  CameraSettings camera;
};

/// What a camera says of itself is text from outside.
void print(const std::string& lines) { fmt::print("{}", printable_lines(lines)); }

void list(const CameraVerbSettings& settings) {
  if (!settings.device.empty()) {
    print(describe_camera(live::list_camera(live::system_calls(), settings.device)));
    return;
  }
  const std::vector<live::ListedCamera> cameras = live::list_cameras(live::system_calls());
  for (const live::ListedCamera& camera : cameras) print(describe_camera(camera));
  if (!cameras.empty()) return;
  fmt::print(
      "no camera: there is no /dev/video*\n"
      "  `lsusb` shows whether it is plugged in, `sudo dmesg | grep -i video` what the kernel "
      "made\n"
      "  of it, `sudo modprobe uvcvideo` loads the driver of USB cameras; in a container or "
      "virtual\n"
      "  machine, the device has to be passed in; users of cameras are in the group video\n");
}

/// The device asked for, or the first camera that there is.
std::string device_of(const CameraVerbSettings& settings) {
  if (!settings.device.empty()) return settings.device;
  for (const live::ListedCamera& camera : live::list_cameras(live::system_calls())) {
    if (camera.fault.empty()) return camera.path;
  }
  throw SetupError({"camera", "there is none", "`seqloop camera` says what was looked at"});
}

/// @return whether frames came, or the user asked to stop; else the camera is given up
bool capture(live::Camera& camera, Clock& clock, std::size_t frames, FrameTimes& times) {
  const std::atomic<bool> stop{false};  // `next` returns in a second anyway
  Progress progress("capturing", frames);
  Nanoseconds last = clock.now();
  Captured captured;
  for (std::size_t taken = 0; taken < frames && !interrupted();) {
    camera.next(captured, stop);
    const bool frame = captured.what == Capture::frame;
    if (!frame && captured.what != Capture::bad_frame) {
      if (!captured.fault.empty()) progress.tell(captured.fault.view());
      if (clock.now() - last > patience) {
        progress.done();
        return false;
      }
      continue;
    }
    const FixedText& what = frame ? captured.remark : captured.fault;
    if (!what.empty()) progress.tell(fmt::format("frame {}: {}", captured.index, what.view()));
    last = captured.arrived;
    times.add(captured);
    camera.give_back(captured);
    progress.step();
    ++taken;
  }
  progress.done();
  return true;
}

void measure(const CameraVerbSettings& settings, std::size_t frames) {
  take_interruptions();
  const live::CameraOptions options =
      camera_options(settings.camera, device_of(settings), built_in, settings.fps);
  live::SteadyClock clock;
  live::Camera camera(options, live::system_calls(), clock);
  FrameTimes times;
  const bool came = capture(camera, clock, frames, times);
  print(times.report(options, camera.facts(), camera.counters()));
  if (!came) throw std::runtime_error(options.path + ": no frame came for 10 s: given up");
}

void look_at_cameras(const CameraVerbSettings& settings, Faults faults) {
  if (settings.frames == 0) faults.push_back({"frames", "0 is not above 0"});
  if (!settings.frames) {
    refuse_given(faults,
                 {{"format", settings.camera.format.has_value()},
                  {"size", settings.camera.size.has_value()},
                  {"fps", settings.fps != CameraVerbSettings{}.fps}},
                 "nothing is captured, cameras are listed", "--frames N");
  }
  refuse(std::move(faults));
  if (settings.frames) {
    measure(settings, *settings.frames);
  } else {
    list(settings);
  }
}

}  // namespace

Verb camera_verb() {
  const auto settings = std::make_shared<CameraVerbSettings>();
  Verb verb{"camera",
            "List cameras with what they offer, or capture from one and report on its frames",
            {},
            [settings](Faults faults) { look_at_cameras(*settings, std::move(faults)); }};
  verb.options.section("Task");
  verb.options.text("device", settings->device,
                    "/dev/video0, or a link to it [all; for --frames, the first camera]");
  verb.options.add({"frames", ValueKind::count, "frames to capture; without it, cameras are listed",
                    [settings](std::string_view value) { settings->frames = parse_count(value); }});
  verb.options.add({"fps", ValueKind::number, "frames a second, at least [10]",
                    [settings](std::string_view value) {
                      settings->fps = parse_number(value);
                      if (!(settings->fps >= 1e-3 && settings->fps <= 1e6)) {
                        throw std::invalid_argument("it must be between 0.001 and 1000000");
                      }
                    }});
  add_camera_options(verb.options, settings->camera);
  return verb;
}

}  // namespace seqloop::program
