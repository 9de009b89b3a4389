#pragma once

#include <optional>
#include <string>
#include <utility>

#include "linux/camera.hpp"
#include "seqloop/options.hpp"
#include "seqloop/raw_picture.hpp"

namespace seqloop::program {

/// What a user may insist on, of a camera.
struct CameraSettings {
  std::optional<RawFormat> format;
  std::optional<std::pair<int, int>> size;  ///< width, height
};

/// The flags --format and --size of a camera. The rate is another flag, --fps, which folders have
/// too. @param settings lives as long as the table
void add_camera_options(OptionTable& options, CameraSettings& settings);

/// @param least_width, least_height pixels that the descriptor takes in
/// @param fps frames a second, at least
[[nodiscard]] live::CameraOptions camera_options(const CameraSettings& settings,
                                                 const std::string& path, int least_width,
                                                 int least_height, bool colour, double fps);

}  // namespace seqloop::program
