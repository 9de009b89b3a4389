// SPDX-License-Identifier: MIT
#include "program/drives/live_camera.hpp"

#include <fmt/format.h>

#include <utility>

#include "program/drives/camera_decoder.hpp"
#include "program/drives/warm_up.hpp"
#include "program/options/verb.hpp"
#include "program/process/interruption.hpp"
#include "seqloop/linux/camera.hpp"

namespace seqloop::program {

bool is_camera(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_character_file(path, error)) return true;
  const std::string name = path.lexically_normal().string();
  return name.starts_with("/dev/video") || name.starts_with("/dev/v4l/");
}

void check_camera(const CameraSettings& settings, const std::filesystem::path& source,
                  Faults& faults) {
  if (is_camera(source)) return;
  refuse_given(faults,
               {{"format", settings.format.has_value()}, {"size", settings.size.has_value()}},
               "it goes with a camera, and the source is none");
}

LiveCamera open_camera(const std::filesystem::path& path, const CameraSettings& settings,
                       double fps, Describer& describer, const RealTimeSettings& real_time,
                       Clock& clock) {
  const PictureNeeds needs = describer.needs();
  const live::CameraOptions options = camera_options(settings, path.string(), needs, fps);
  auto camera = std::make_unique<live::Camera>(options, live::system_calls(), clock);
  const live::CameraFacts facts = camera->facts();
  auto decoder = std::make_unique<CameraDecoder>(
      needs, "ask for another --size or --format; `seqloop camera` lists what there is");
  warm_up(*decoder, describer, facts.mode.format, facts.mode.width, facts.mode.height);
  live::LiveSettings source_settings = live_settings(real_time);
  source_settings.hang_timeout += options.timeout;
  source_settings.from_first_taken = true;
  std::string mode = fmt::format("{}, {}", facts.identity.card, to_string(facts.mode));
  const double rate = live::rate(facts.mode);
  if (rate > 0.0 && rate < 0.98 * fps) {
    mode += fmt::format(", which is less than the {:g} fps asked for", fps);
  }
  return {std::make_unique<live::LiveSource>(std::move(camera), std::move(decoder), clock,
                                             std::move(source_settings)),
          std::move(mode)};
}

live::LiveSettings live_settings(const RealTimeSettings& real_time) {
  live::LiveSettings settings;
  settings.stop = interrupted;
  settings.at_start = [thread = real_time.capture_thread()] {
    Faults refused = live::schedule(thread, "capture thread");
    if (!refused.empty()) throw SetupError(std::move(refused));
    live::touch_stack();
  };
  return settings;
}

}  // namespace seqloop::program
