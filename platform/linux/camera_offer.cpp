// SPDX-License-Identifier: MIT
#include "linux/camera_offer.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "seqloop/linux/detail/picture_format.hpp"
#include "seqloop/linux/pixel_format.hpp"

namespace seqloop::live {
namespace {

using Size = std::pair<std::uint32_t, std::uint32_t>;

// No camera has as many: a driver that never says stop is left there.
constexpr std::uint32_t most_formats = 64;
constexpr std::uint32_t most_sizes = 256;
constexpr std::uint32_t most_intervals = 128;

std::string text_of(Size size) {
  return std::to_string(size.first) + 'x' + std::to_string(size.second);
}

/// Of a range, the least value that is at least the wished one.
std::uint32_t step_up(std::uint32_t least, std::uint32_t most, std::uint32_t step, int wished) {
  if (wished < 0 || static_cast<std::uint32_t>(wished) <= least) return least;
  const std::uint32_t width = std::max(step, 1U);
  const std::uint64_t steps = (static_cast<std::uint64_t>(wished) - least + width - 1) / width;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(least + steps * width, most));
}

class Reader {
 public:
  Reader(SystemCalls& system, int fd, std::uint32_t type, const CameraWish& wish)
      : system_(system), fd_(fd), type_(type), wish_(wish) {}

  CameraOffer read() {
    for (std::uint32_t index = 0; index < most_formats; ++index) {
      v4l2_fmtdesc description{};
      description.index = index;
      description.type = type_;
      if (system_.ioctl(fd_, VIDIOC_ENUM_FMT, &description) != 0) break;
      const std::uint32_t fourcc = description.pixelformat;
      if (const auto format = readable(fourcc)) {
        read_sizes({fourcc, *format, 0, 0, 0, 0});
      } else {
        const auto* const words = reinterpret_cast<const char*>(description.description);
        offer_.other_formats.push_back(
            fourcc_text(fourcc) + " (" +
            std::string(words, strnlen(words, sizeof description.description)) + ")");
      }
    }
    return std::move(offer_);
  }

 private:
  void read_sizes(const CameraMode& format) {
    for (std::uint32_t index = 0; index < most_sizes; ++index) {
      v4l2_frmsizeenum sizes{};
      sizes.index = index;
      sizes.pixel_format = format.fourcc;
      if (system_.ioctl(fd_, VIDIOC_ENUM_FRAMESIZES, &sizes) != 0) {
        if (index == 0) read_size_by_trying(format);
        return;
      }
      if (sizes.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
        read_rates(format, {sizes.discrete.width, sizes.discrete.height});
        continue;
      }
      read_size_range(format, sizes.stepwise);
      return;
    }
  }

  void read_size_range(const CameraMode& format, const v4l2_frmsize_stepwise& range) {
    const Size least{range.min_width, range.min_height};
    const Size most{range.max_width, range.max_height};
    offer_.ranges.push_back(fourcc_text(format.fourcc) + ": sizes from " + text_of(least) + " to " +
                            text_of(most) + " in steps of " +
                            text_of({range.step_width, range.step_height}));
    const auto [width, height] = wished_size();
    const Size fitting{step_up(least.first, most.first, range.step_width, width),
                       step_up(least.second, most.second, range.step_height, height)};
    read_rates(format, fitting);
    if (most != fitting) read_rates(format, most);
  }

  void read_size_by_trying(const CameraMode& format) {
    const auto [width, height] = wished_size();
    PictureFormat tried;
    CameraMode mode = format;
    mode.width = width > 0 ? width : 640;
    mode.height = height > 0 ? height : 480;
    if (try_format(system_, fd_, type_, mode, tried) != 0 || tried.fourcc != format.fourcc) {
      if (read_format(system_, fd_, type_, tried) != 0 || tried.fourcc != format.fourcc) return;
    }
    read_rates(format,
               {static_cast<std::uint32_t>(tried.width), static_cast<std::uint32_t>(tried.height)});
  }

  void read_rates(const CameraMode& format, Size size) {
    constexpr std::uint32_t most = 1U << 20U;
    if (size.first == 0 || size.second == 0 || size.first > most || size.second > most) return;
    CameraMode mode = format;
    mode.width = static_cast<int>(size.first);
    mode.height = static_cast<int>(size.second);
    for (std::uint32_t index = 0; index < most_intervals; ++index) {
      v4l2_frmivalenum intervals{};
      intervals.index = index;
      intervals.pixel_format = format.fourcc;
      intervals.width = size.first;
      intervals.height = size.second;
      if (system_.ioctl(fd_, VIDIOC_ENUM_FRAMEINTERVALS, &intervals) != 0) {
        if (index == 0) offer_.modes.push_back(mode);
        return;
      }
      if (intervals.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
        add(mode, intervals.discrete);
        continue;
      }
      read_rate_range(mode, intervals.stepwise);
      return;
    }
  }

  void read_rate_range(const CameraMode& mode, const v4l2_frmival_stepwise& range) {
    const auto seconds = [](const v4l2_fract& interval) {
      return interval.denominator == 0 ? 0.0 : interval.numerator * 1.0 / interval.denominator;
    };
    CameraMode slowest = mode;
    slowest.interval_numerator = range.max.numerator;
    slowest.interval_denominator = range.max.denominator;
    add(mode, range.min);
    const double wished = 1.0 / std::max(wish_.rate, 1e-3);
    if (seconds(range.max) <= wished) {
      add(mode, range.max);
    } else if (seconds(range.min) < wished) {
      constexpr std::uint32_t units = 1'000'000;
      add(mode, {static_cast<std::uint32_t>(std::lround(std::min(wished, 1000.0) * units)), units});
    }
    CameraMode fastest = mode;
    fastest.interval_numerator = range.min.numerator;
    fastest.interval_denominator = range.min.denominator;
    offer_.ranges.push_back("rates from " + to_string(slowest) + " to " + to_string(fastest));
  }

  void add(CameraMode mode, const v4l2_fract& interval) {
    mode.interval_numerator = interval.numerator;
    mode.interval_denominator = interval.denominator;
    offer_.modes.push_back(mode);
  }

  [[nodiscard]] std::pair<int, int> wished_size() const {
    return wish_.size.value_or(std::pair(wish_.least_width, wish_.least_height));
  }

  SystemCalls& system_;
  int fd_;
  std::uint32_t type_;
  const CameraWish& wish_;
  CameraOffer offer_;
};

}  // namespace

CameraOffer read_offer(SystemCalls& system, int fd, std::uint32_t type, const CameraWish& wish) {
  return Reader(system, fd, type, wish).read();
}

}  // namespace seqloop::live
