// SPDX-License-Identifier: MIT
#include "program/options/camera_options.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "program/options/picture_margin.hpp"
#include "seqloop/linux/pixel_format.hpp"

namespace seqloop::program {

void add_camera_options(OptionTable& options, CameraSettings& settings) {
  options.section("Camera");
  options.add({"format", ValueKind::text,
               "GREY, BGR3, RGB3, YUYV, UYVY, NV12, YU12 or MJPG [the cheapest]",
               [&settings](std::string_view value) {
                 settings.format = live::format_named(value);
                 if (!settings.format) {
                   throw std::invalid_argument(
                       "'" + std::string(value) +
                       "' is none of GREY, BGR3, RGB3, YUYV, UYVY, NV12, YU12, MJPG");
                 }
               }});
  options.add({"size", ValueKind::size,
               "of the pictures: WxH, exactly [the cheapest that the descriptor can use]",
               [&settings](std::string_view value) { settings.size = parse_size(value); }});
}

live::CameraOptions camera_options(const CameraSettings& settings, const std::string& path,
                                   const PictureNeeds& needs, double fps) {
  constexpr double frames_to_wait = 3.0;
  const PictureNeeds wanted = with_margin(needs);
  live::CameraOptions options;
  options.path = path;
  options.timeout = std::max(
      options.timeout,
      std::chrono::duration_cast<Nanoseconds>(std::chrono::duration<double>(frames_to_wait / fps)));
  options.wish = {.least_width = wanted.width,
                  .least_height = wanted.height,
                  .colour = !needs.gray_is_enough,
                  .rate = fps,
                  .format = settings.format,
                  .size = settings.size};
  return options;
}

}  // namespace seqloop::program
