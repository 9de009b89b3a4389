// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "program/options/camera_options.hpp"
#include "program/options/real_time_options.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/linux/live_source.hpp"

namespace seqloop::program {

/// A camera that delivers, and what it was set to.
struct LiveCamera {
  std::unique_ptr<live::LiveSource> source;
  std::string mode;  ///< for people: card, format, size, rate
};

/// Whether a path means a camera rather than a recording: a device, or a name in /dev.
[[nodiscard]] bool is_camera(const std::filesystem::path& path);

/// Adds a fault for what is asked of a camera where the source is none.
void check_camera(const CameraSettings& settings, const std::filesystem::path& source,
                  Faults& faults);

/// Opens a camera in the cheapest mode that serves the describer, warms decoder and describer up
/// for it, and starts to capture. Waits a while for one that is busy. Throws SetupError.
/// @param fps   frames a second wanted   @param clock lives longer than the source
[[nodiscard]] LiveCamera open_camera(const std::filesystem::path& path,
                                     const CameraSettings& settings, double fps,
                                     Describer& describer, const RealTimeSettings& real_time,
                                     Clock& clock);

/// How a live source's capture thread is set up: scheduled as asked, ended by an interruption.
[[nodiscard]] live::LiveSettings live_settings(const RealTimeSettings& real_time);

}  // namespace seqloop::program
