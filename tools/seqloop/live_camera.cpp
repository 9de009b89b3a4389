#include "seqloop/live_camera.hpp"

#include <fmt/format.h>

#include <utility>

#include "linux/camera.hpp"
#include "seqloop/camera_decoder.hpp"
#include "seqloop/interruption.hpp"
#include "seqloop/warm_up.hpp"

namespace seqloop::program {

bool is_camera(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_character_file(path, error)) return true;
  const std::string name = path.lexically_normal().string();
  return name.starts_with("/dev/video") || name.starts_with("/dev/v4l/");
}

LiveCamera open_camera(const std::filesystem::path& path, const CameraSettings& settings,
                       double fps, Describer& describer, const RealTimeSettings& real_time,
                       Clock& clock) {
  const PictureNeeds needs = describer.needs();
  auto camera =
      std::make_unique<live::Camera>(camera_options(settings, path.string(), needs.width,
                                                    needs.height, !needs.gray_is_enough, fps),
                                     live::system_calls(), clock);
  const live::CameraFacts facts = camera->facts();
  auto decoder = std::make_unique<CameraDecoder>(needs);
  warm_up(*decoder, describer, facts.mode.format, facts.mode.width, facts.mode.height);
  return {std::make_unique<live::LiveSource>(std::move(camera), std::move(decoder), clock,
                                             live_settings(real_time)),
          fmt::format("{}, {}", facts.identity.card, to_string(facts.mode))};
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
