// SPDX-License-Identifier: MIT
#include "seqloop/linux/detail/video_node.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace seqloop::live {
namespace {

/// Texts of the kernel end with a zero, if they are shorter than their room.
template <std::size_t size>
std::string text_of(const __u8 (&letters)[size]) {
  const auto* const end = std::find(std::begin(letters), std::end(letters), __u8{0});
  return {std::begin(letters), end};
}

Refused refused_by(int error) noexcept {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case ENOTDIR:
      return Refused::missing;
    case EACCES:
    case EPERM:
      return Refused::denied;
    case EBUSY:
      return Refused::busy;
    default:
      return Refused::failed;
  }
}

}  // namespace

int read_facts(SystemCalls& system, int fd, const std::string& path, NodeFacts& facts) {
  v4l2_capability capability{};
  if (const int error = system.ioctl(fd, VIDIOC_QUERYCAP, &capability); error != 0) return error;
  facts.capabilities = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                           ? capability.device_caps
                           : capability.capabilities;
  facts.identity.driver = text_of(capability.driver);
  facts.identity.card = text_of(capability.card);
  facts.identity.bus = text_of(capability.bus_info);
  const std::string real = system.resolve(path);
  const std::string sysfs = "/sys/class/video4linux/" + real.substr(real.rfind('/') + 1);
  facts.identity.index = system.read_text(sysfs + "/index");
  // The node belongs to one interface of a USB device; what is above that has the serial number.
  facts.identity.serial = system.read_text(sysfs + "/device/../serial");
  return 0;
}

std::uint32_t capture_type(std::uint32_t capabilities) noexcept {
  // What also puts pictures out turns others' pictures round: no camera.
  constexpr std::uint32_t both = V4L2_CAP_VIDEO_M2M | V4L2_CAP_VIDEO_M2M_MPLANE;
  if ((capabilities & V4L2_CAP_STREAMING) == 0 || (capabilities & both) != 0) return 0;
  if ((capabilities & V4L2_CAP_VIDEO_CAPTURE) != 0) return V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if ((capabilities & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0) {
    return V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  }
  return 0;
}

std::variant<VideoNode, Refusal> open_node(SystemCalls& system, const std::string& path) {
  const FileFacts file = system.facts(path);
  if (file.kind == FileKind::missing) {
    return Refusal{refused_by(file.error), "looking for it", file.error, file.kind, {}};
  }
  // Others are not even opened: doing so rewinds tapes and arms watchdogs.
  if (file.kind != FileKind::video_device) {
    return Refusal{Refused::no_video, "looking at it", 0, file.kind, {}};
  }
  const SystemCalls::Opened opened = system.open(path.c_str());
  if (opened.error != 0)
    return Refusal{refused_by(opened.error), "open", opened.error, file.kind, {}};
  VideoNode node{UniqueFd(system, opened.fd), path, {}, 0};
  NodeFacts facts;
  if (const int error = read_facts(system, opened.fd, path, facts); error != 0) {
    const Refused why = error == ENOTTY || error == EINVAL ? Refused::no_video : refused_by(error);
    return Refusal{why, "QUERYCAP", error, file.kind, {}};
  }
  node.identity = std::move(facts.identity);
  node.buffer_type = capture_type(facts.capabilities);
  if (node.buffer_type == 0) return Refusal{Refused::no_capture, "QUERYCAP", 0, file.kind, {}};
  return node;
}

std::vector<std::string> video_paths(SystemCalls& system) {
  constexpr std::string_view stem = "video";
  std::vector<std::pair<unsigned long, std::string>> found;
  for (const std::string& name : system.list_folder("/dev")) {
    const std::string number = name.starts_with(stem) ? name.substr(stem.size()) : std::string();
    const bool digits = !number.empty() && number.size() < 6 &&
                        number.find_first_not_of("0123456789") == std::string::npos;
    if (digits) found.emplace_back(std::stoul(number), "/dev/" + name);
  }
  std::ranges::sort(found);
  std::vector<std::string> paths;
  paths.reserve(found.size());
  for (auto& [number, path] : found) paths.push_back(std::move(path));
  return paths;
}

}  // namespace seqloop::live
