// SPDX-License-Identifier: MIT
#include "seqloop/linux/detail/picture_format.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <limits>

namespace seqloop::live {
namespace {

int pixels(std::uint32_t count) noexcept {
  return static_cast<int>(
      std::min(count, static_cast<std::uint32_t>(std::numeric_limits<int>::max())));
}

int taken(const v4l2_format& format, PictureFormat& given) noexcept {
  if (format.type == V4L2_BUF_TYPE_VIDEO_CAPTURE) {
    const v4l2_pix_format& picture = format.fmt.pix;
    given = {picture.pixelformat, pixels(picture.width), pixels(picture.height),
             picture.bytesperline, picture.sizeimage};
    return 0;
  }
  const v4l2_pix_format_mplane& picture = format.fmt.pix_mp;
  given = {picture.pixelformat, pixels(picture.width), pixels(picture.height),
           picture.plane_fmt[0].bytesperline, picture.plane_fmt[0].sizeimage};
  return picture.num_planes == 1 ? 0 : EINVAL;
}

int ask(SystemCalls& system, int fd, unsigned long request, std::uint32_t type,
        const CameraMode& mode, PictureFormat& given) noexcept {
  v4l2_format format{};
  format.type = type;
  if (type == V4L2_BUF_TYPE_VIDEO_CAPTURE) {
    format.fmt.pix.pixelformat = mode.fourcc;
    format.fmt.pix.width = static_cast<std::uint32_t>(mode.width);
    format.fmt.pix.height = static_cast<std::uint32_t>(mode.height);
    format.fmt.pix.field = V4L2_FIELD_NONE;
  } else {
    format.fmt.pix_mp.pixelformat = mode.fourcc;
    format.fmt.pix_mp.width = static_cast<std::uint32_t>(mode.width);
    format.fmt.pix_mp.height = static_cast<std::uint32_t>(mode.height);
    format.fmt.pix_mp.field = V4L2_FIELD_NONE;
    format.fmt.pix_mp.num_planes = 1;
  }
  const int error = system.ioctl(fd, request, &format);
  return error != 0 ? error : taken(format, given);
}

}  // namespace

int read_format(SystemCalls& system, int fd, std::uint32_t type, PictureFormat& given) noexcept {
  return ask(system, fd, VIDIOC_G_FMT, type, {}, given);
}

int try_format(SystemCalls& system, int fd, std::uint32_t type, const CameraMode& mode,
               PictureFormat& given) noexcept {
  return ask(system, fd, VIDIOC_TRY_FMT, type, mode, given);
}

int set_format(SystemCalls& system, int fd, std::uint32_t type, const CameraMode& mode,
               PictureFormat& given) noexcept {
  return ask(system, fd, VIDIOC_S_FMT, type, mode, given);
}

void set_rate(SystemCalls& system, int fd, std::uint32_t type, CameraMode& mode) noexcept {
  v4l2_streamparm parameters{};
  parameters.type = type;
  parameters.parm.capture.timeperframe = {mode.interval_numerator, mode.interval_denominator};
  int error = 0;
  if (mode.interval_numerator != 0) {
    error = system.ioctl(fd, VIDIOC_S_PARM, &parameters);
  }
  if (mode.interval_numerator == 0 || error != 0) {
    parameters = {};
    parameters.type = type;
    error = system.ioctl(fd, VIDIOC_G_PARM, &parameters);
  }
  const v4l2_captureparm& given = parameters.parm.capture;
  const bool told = error == 0 && (given.capability & V4L2_CAP_TIMEPERFRAME) != 0;
  mode.interval_numerator = told ? given.timeperframe.numerator : 0;
  mode.interval_denominator = told ? given.timeperframe.denominator : 0;
}

}  // namespace seqloop::live
