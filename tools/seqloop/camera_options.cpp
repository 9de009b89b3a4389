#include "seqloop/camera_options.hpp"

#include <stdexcept>

#include "linux/pixel_format.hpp"

namespace seqloop::program {

void add_camera_options(OptionTable& options, CameraSettings& settings) {
  options.add({"format", ValueKind::text,
               "of a camera: GREY, BGR3, RGB3, YUYV, UYVY, NV12, YU12 or MJPG [the cheapest]",
               [&settings](std::string_view value) {
                 settings.format = live::format_named(value);
                 if (!settings.format) {
                   throw std::invalid_argument(
                       "'" + std::string(value) +
                       "' is none of GREY, BGR3, RGB3, YUYV, UYVY, NV12, YU12, MJPG");
                 }
               }});
  options.add({"size", ValueKind::size,
               "of a camera's pictures: WxH, exactly [the cheapest that the descriptor can use]",
               [&settings](std::string_view value) { settings.size = parse_size(value); }});
}

live::CameraOptions camera_options(const CameraSettings& settings, const std::string& path,
                                   int least_width, int least_height, bool colour, double fps) {
  live::CameraOptions options;
  options.path = path;
  options.wish = {.least_width = least_width,
                  .least_height = least_height,
                  .colour = colour,
                  .rate = fps,
                  .format = settings.format,
                  .size = settings.size};
  return options;
}

}  // namespace seqloop::program
