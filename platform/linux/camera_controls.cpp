// SPDX-License-Identifier: MIT
#include "seqloop/linux/camera_controls.hpp"

#include <linux/videodev2.h>

#include <cstring>
#include <optional>

namespace seqloop::live {
namespace {

constexpr std::uint32_t most_controls = 512;
constexpr std::int64_t most_items = 64;

/// Nothing for headings and for what holds no single number.
const char* type_text(std::uint32_t type) {
  switch (type) {
    case V4L2_CTRL_TYPE_INTEGER:
      return "int";
    case V4L2_CTRL_TYPE_INTEGER64:
      return "int64";
    case V4L2_CTRL_TYPE_BOOLEAN:
      return "bool";
    case V4L2_CTRL_TYPE_MENU:
    case V4L2_CTRL_TYPE_INTEGER_MENU:
      return "menu";
    case V4L2_CTRL_TYPE_BITMASK:
      return "bitmask";
    default:
      return nullptr;
  }
}

std::string item_text(SystemCalls& system, int fd, std::uint32_t id, std::uint32_t type,
                      std::uint32_t index) {
  v4l2_querymenu item{};
  item.id = id;
  item.index = index;
  if (system.ioctl(fd, VIDIOC_QUERYMENU, &item) != 0) return {};
  std::string text = std::to_string(index) + ": ";
  if (type == V4L2_CTRL_TYPE_INTEGER_MENU) return text + std::to_string(std::int64_t{item.value});
  const auto* const name = reinterpret_cast<const char*>(item.name);
  return text.append(name, strnlen(name, sizeof item.name));
}

void read_value(SystemCalls& system, int fd, std::uint32_t id, CameraControl& control) {
  v4l2_ext_control one{};
  one.id = id;
  v4l2_ext_controls asked{};
  asked.which = V4L2_CTRL_WHICH_CUR_VAL;
  asked.count = 1;
  asked.controls = &one;
  control.readable = system.ioctl(fd, VIDIOC_G_EXT_CTRLS, &asked) == 0;
  if (control.readable) control.value = control.type == "int64" ? one.value64 : one.value;
}

}  // namespace

std::vector<CameraControl> read_controls(SystemCalls& system, int fd) {
  std::vector<CameraControl> controls;
  constexpr std::uint32_t next = V4L2_CTRL_FLAG_NEXT_CTRL;
  v4l2_query_ext_ctrl asked{};
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < most_controls; ++i) {
    asked = {};
    asked.id = last | next;
    if (system.ioctl(fd, VIDIOC_QUERY_EXT_CTRL, &asked) != 0 || asked.id <= last) break;
    last = asked.id;
    const char* const type = type_text(asked.type);
    const bool off = (asked.flags & V4L2_CTRL_FLAG_DISABLED) != 0;
    if (type == nullptr || off || asked.nr_of_dims != 0) continue;
    CameraControl& control = controls.emplace_back();
    control.name.assign(asked.name, strnlen(asked.name, sizeof asked.name));
    control.type = type;
    control.minimum = asked.minimum;
    control.maximum = asked.maximum;
    control.step = static_cast<std::int64_t>(asked.step);
    control.preset = asked.default_value;
    if ((asked.flags & V4L2_CTRL_FLAG_WRITE_ONLY) == 0) read_value(system, fd, asked.id, control);
    if (control.type != "menu" || control.minimum < 0) continue;
    for (std::int64_t item = control.minimum;
         item <= control.maximum && item < control.minimum + most_items; ++item) {
      std::string text =
          item_text(system, fd, asked.id, asked.type, static_cast<std::uint32_t>(item));
      if (!text.empty()) control.items.push_back(std::move(text));
    }
  }
  return controls;
}

}  // namespace seqloop::live
