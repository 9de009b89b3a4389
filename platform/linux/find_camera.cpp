// SPDX-License-Identifier: MIT
#include "seqloop/linux/detail/find_camera.hpp"

#include <algorithm>
#include <array>
#include <variant>

namespace seqloop::live {
namespace {

enum Likeness : std::size_t { none, same_kind, same_serial_or_place, same };

Likeness likeness(const CameraIdentity& here, const CameraIdentity& wanted) {
  if (here.driver != wanted.driver || here.card != wanted.card) return none;
  if (here.index != wanted.index) return none;
  const bool both_numbered = !here.serial.empty() && !wanted.serial.empty();
  if (both_numbered && here.serial != wanted.serial) return none;
  if (here.bus == wanted.bus) return here.serial == wanted.serial ? same : same_serial_or_place;
  return both_numbered ? same_serial_or_place : same_kind;
}

bool is_link(SystemCalls& system, const std::string& path) {
  const std::string real = system.resolve(path);
  return !real.empty() && real != path;
}

/// Nodes by the usual names, and the user's own where that is another, as a container may give it.
std::vector<std::string> nodes(SystemCalls& system, const std::string& path) {
  std::vector<std::string> paths = video_paths(system);
  const std::string real = system.resolve(path);
  if (!real.empty() && std::ranges::find(paths, real) == paths.end()) paths.push_back(real);
  return paths;
}

}  // namespace

std::string find_camera(SystemCalls& system, const std::string& path,
                        const CameraIdentity& identity, const Twins& twins) {
  if (is_link(system, path)) return path;
  std::array<std::vector<std::string>, same + 1> like;
  for (const std::string& candidate : nodes(system, path)) {
    const auto node = open_node(system, candidate);
    if (const auto* const camera = std::get_if<VideoNode>(&node)) {
      like[likeness(camera->identity, identity)].push_back(candidate);
    }
  }
  if (!like[same].empty()) {
    const bool at_home = std::ranges::find(like[same], path) != like[same].end();
    return at_home ? path : like[same].front();
  }
  if (like[same_serial_or_place].size() == 1 && twins.serial <= 1) {
    return like[same_serial_or_place].front();
  }
  if (like[same_kind].size() == 1 && twins.kind <= 1) return like[same_kind].front();
  return {};
}

Twins count_twins(SystemCalls& system, const std::string& path, const CameraIdentity& identity) {
  Twins twins{0, 0};
  for (const std::string& candidate : nodes(system, path)) {
    const auto node = open_node(system, candidate);
    const auto* const camera = std::get_if<VideoNode>(&node);
    if (camera == nullptr) continue;
    const CameraIdentity& other = camera->identity;
    const bool same_kind = other.driver == identity.driver && other.card == identity.card &&
                           other.index == identity.index;
    if (!same_kind) continue;
    ++twins.kind;
    if (other.serial == identity.serial) ++twins.serial;
  }
  return twins;
}

}  // namespace seqloop::live
