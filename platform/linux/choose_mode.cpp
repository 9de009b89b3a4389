// SPDX-License-Identifier: MIT
#include "linux/choose_mode.hpp"

#include <algorithm>
#include <tuple>

namespace seqloop::live {
namespace {

constexpr double rate_tolerance = 0.98;

double weight(RawFormat format, bool colour) noexcept {
  switch (format) {
    case RawFormat::gray8:
      return 1.0;
    case RawFormat::nv12:
    case RawFormat::yu12:
      return colour ? 8.0 : 1.25;
    case RawFormat::yuyv:
    case RawFormat::uyvy:
      return colour ? 7.0 : 2.0;
    case RawFormat::bgr8:
      return 3.0;
    case RawFormat::rgb8:
      return colour ? 6.0 : 3.0;
    default:  // mjpg; the others are of no camera here
      break;
  }
  return colour ? 20.0 : 12.0;
}

/// What is left of the work when a JPEG picture is decoded as small as it may be.
double reduced_share(const CameraMode& mode, const CameraWish& wish) noexcept {
  if (wish.least_width <= 0 || wish.least_height <= 0) return 1.0;
  int divisor = 8;
  while (divisor > 1 &&
         (mode.width / divisor < wish.least_width || mode.height / divisor < wish.least_height)) {
    divisor /= 2;
  }
  return 0.4 + 0.6 / (divisor * divisor);
}

}  // namespace

bool serves(const CameraMode& mode, const CameraWish& wish) noexcept {
  if (mode.width <= 0 || mode.height <= 0) return false;
  if (wish.colour && mode.format == RawFormat::gray8) return false;
  if (wish.format && *wish.format != mode.format) return false;
  return !wish.size || *wish.size == std::pair(mode.width, mode.height);
}

double cost(const CameraMode& mode, const CameraWish& wish) noexcept {
  const double pixels = static_cast<double>(mode.width) * mode.height;
  const double frames = rate(mode) > 0.0 ? rate(mode) : wish.rate;
  const double share = mode.format == RawFormat::mjpg ? reduced_share(mode, wish) : 1.0;
  return pixels * frames * weight(mode.format, wish.colour) * share;
}

std::vector<CameraMode> choose_mode(const std::vector<CameraMode>& modes, const CameraWish& wish) {
  std::vector<CameraMode> chosen;
  std::ranges::copy_if(modes, std::back_inserter(chosen),
                       [&](const CameraMode& mode) { return serves(mode, wish); });
  const auto badness = [&wish](const CameraMode& mode) {
    const double frames = rate(mode);
    const bool fast = frames == 0.0 || frames >= wish.rate * rate_tolerance;
    const bool large = mode.width >= wish.least_width && mode.height >= wish.least_height;
    const double pixels = static_cast<double>(mode.width) * mode.height;
    return std::tuple(fast ? 0.0 : 1.0 / frames, large ? 0.0 : 1.0 / pixels, cost(mode, wish));
  };
  std::ranges::stable_sort(chosen, {}, badness);
  return chosen;
}

}  // namespace seqloop::live
