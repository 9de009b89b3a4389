// SPDX-License-Identifier: MIT
#include "linux/refusal_text.hpp"

#include <algorithm>
#include <variant>
#include <vector>

#include "linux/error_text.hpp"

namespace seqloop::live {
namespace {

constexpr const char* list_remedy = "`seqloop camera` lists what is there";

std::string joined(const std::vector<std::string>& words, std::size_t most = 12) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i == most) return text + " and " + std::to_string(words.size() - most) + " more";
    if (i > 0) text += ", ";
    text += words[i];
  }
  return text;
}

/// Programs that have the device open, `guvcview (pid 812)`. Others' are only seen by root.
std::vector<std::string> holders(SystemCalls& system, const std::string& path) {
  std::vector<std::string> found;
  const std::string real = system.resolve(path);
  const std::string ourselves = system.resolve("/proc/self");
  for (const std::string& name : system.list_folder("/proc")) {
    if (name.empty() || name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string process = "/proc/" + name;
    if (process == ourselves) continue;
    const std::string open_files = process + "/fd/";
    for (const std::string& fd : system.list_folder(open_files)) {
      if (system.resolve(open_files + fd) != real) continue;
      std::string& program = found.emplace_back(system.read_text(process + "/comm"));
      program.append(" (pid ").append(name).append(")");
      break;
    }
  }
  return found;
}

/// Other nodes of the same card that do capture.
std::vector<std::string> siblings(SystemCalls& system, const std::string& path) {
  std::vector<std::string> found;
  const SystemCalls::Opened opened = system.open(path.c_str());
  if (opened.error != 0) return found;
  const UniqueFd fd(system, opened.fd);
  NodeFacts ours;
  if (read_facts(system, fd.get(), path, ours) != 0) return found;
  for (const std::string& other : video_paths(system)) {
    const auto node = open_node(system, other);
    const auto* const camera = std::get_if<VideoNode>(&node);
    if (camera != nullptr && camera->identity.card == ours.identity.card &&
        camera->identity.bus == ours.identity.bus) {
      found.push_back(other);
    }
  }
  return found;
}

std::string kind_text(FileKind kind) {
  switch (kind) {
    case FileKind::folder:
      return "a folder";
    case FileKind::file:
      return "a file";
    case FileKind::other_device:
      return "a device of another kind";
    default:
      return "not a Video4Linux device";
  }
}

std::string failed_call(const Refusal& refusal) {
  return refusal.doing + ": " + std::string(error_text(refusal.error));
}

Fault explain_denied(SystemCalls& system, const std::string& path, const Refusal& refusal) {
  const std::string group = system.facts(path).group;
  if (group.empty()) return {path, "may not be opened (" + failed_call(refusal) + ")"};
  return {path,
          "belongs to the group " + group + ", and this user may not open it (" +
              std::string(error_text(refusal.error)) + ")",
          "sudo usermod -aG " + group + " $USER, then log in again"};
}

Fault explain_busy(SystemCalls& system, const std::string& path, const Refusal& refusal) {
  const std::vector<std::string> programs = holders(system, path);
  const std::string who =
      programs.empty() ? "another program uses it" : joined(programs) + " uses it";
  return {path, who + " (" + failed_call(refusal) + ")",
          programs.empty() ? "end that program; `sudo fuser -v " + path + "` says which it is"
                           : "end that program"};
}

}  // namespace

Fault explain(SystemCalls& system, const std::string& path, const Refusal& refusal) {
  switch (refusal.why) {
    case Refused::missing:
      return {path, "there is no camera (" + failed_call(refusal) + ")", list_remedy};
    case Refused::denied:
      return explain_denied(system, path, refusal);
    case Refused::no_video:
      return {path, "is " + kind_text(refusal.kind) + ", no camera", list_remedy};
    case Refused::no_capture: {
      const std::vector<std::string> others = siblings(system, path);
      return {path, "is a Video4Linux device, but takes no pictures",
              others.empty() ? list_remedy : "of the same device does: " + joined(others)};
    }
    case Refused::no_format:
      return {path,
              refusal.offered.empty()
                  ? "offers no picture format at all"
                  : "offers no format that can be read, only " + joined(refusal.offered),
              refusal.offered.empty() ? "a loopback device has none before something is fed in"
                                      : "it needs one of GREY BGR3 RGB3 YUYV UYVY NV12 YU12 MJPG"};
    case Refused::not_offered:
      return {path, "does not offer that format and size",
              "it offers " + joined(refusal.offered, 40)};
    case Refused::busy:
      return explain_busy(system, path, refusal);
    case Refused::too_few_buffers:
      return {path, "the driver lends fewer than 2 buffers"};
    case Refused::failed:
      break;
  }
  return {path, "the driver refused " + failed_call(refusal),
          "try again; if it stays so, unplug the camera and plug it in again"};
}

std::string brief(const Refusal& refusal) {
  switch (refusal.why) {
    case Refused::no_video:
      return "it is " + kind_text(refusal.kind);
    case Refused::no_capture:
      return "it takes no pictures";
    case Refused::no_format:
      return "it offers no format that can be read";
    case Refused::not_offered:
      return "it does not offer the format and size asked for";
    case Refused::too_few_buffers:
      return "the driver lends fewer than 2 buffers";
    default:
      return failed_call(refusal);
  }
}

}  // namespace seqloop::live
