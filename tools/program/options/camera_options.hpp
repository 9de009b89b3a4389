// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "program/options/options.hpp"
#include "seqloop/linux/camera.hpp"
#include "seqloop/picture_needs.hpp"
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

/// @param needs the describer's
/// @param fps frames a second, at least; at 3 intervals without a frame, but not before a second, a
///   camera counts as silent
[[nodiscard]] live::CameraOptions camera_options(const CameraSettings& settings,
                                                 const std::string& path, const PictureNeeds& needs,
                                                 double fps);

}  // namespace seqloop::program
