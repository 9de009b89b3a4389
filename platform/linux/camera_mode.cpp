// SPDX-License-Identifier: MIT
#include "seqloop/linux/camera_mode.hpp"

#include <array>
#include <cstdio>

#include "seqloop/linux/pixel_format.hpp"

namespace seqloop::live {

double rate(const CameraMode& mode) noexcept {
  if (mode.interval_numerator == 0) return 0.0;
  return static_cast<double>(mode.interval_denominator) / mode.interval_numerator;
}

std::string to_string(const CameraMode& mode) {
  std::string text = fourcc_text(mode.fourcc) + ' ' + std::to_string(mode.width) + 'x' +
                     std::to_string(mode.height);
  if (rate(mode) == 0.0) return text;
  std::array<char, 32> frames{};
  std::snprintf(frames.data(), frames.size(), " at %.4g fps", rate(mode));
  return text + frames.data();
}

}  // namespace seqloop::live
