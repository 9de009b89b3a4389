// SPDX-License-Identifier: MIT
#include "seqloop/linux/camera_list.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "linux/camera_offer.hpp"
#include "linux/refusal_text.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::live {
namespace {

std::vector<std::string> links_to(SystemCalls& system, const std::string& path) {
  std::vector<std::string> links;
  const std::string real = system.resolve(path);
  for (const std::string folder : {"/dev/v4l/by-id/", "/dev/v4l/by-path/"}) {
    for (const std::string& name : system.list_folder(folder)) {
      if (!name.starts_with('.') && system.resolve(folder + name) == real) {
        links.push_back(folder + name);
      }
    }
  }
  std::ranges::sort(links);
  return links;
}

ListedCamera listed(SystemCalls& system, const std::string& path, VideoNode node) {
  ListedCamera camera;
  camera.path = path;
  camera.links = links_to(system, path);
  camera.identity = std::move(node.identity);
  camera.offer = read_offer(system, node.fd.get(), node.buffer_type, {});
  camera.controls = read_controls(system, node.fd.get());
  return camera;
}

}  // namespace

std::vector<ListedCamera> list_cameras(SystemCalls& system) {
  std::vector<ListedCamera> cameras;
  for (const std::string& path : video_paths(system)) {
    auto opened = open_node(system, path);
    if (auto* const node = std::get_if<VideoNode>(&opened)) {
      cameras.push_back(listed(system, path, std::move(*node)));
    } else {
      ListedCamera& other = cameras.emplace_back();
      other.path = path;
      other.fault = to_string(explain(system, path, std::get<Refusal>(opened)));
    }
  }
  return cameras;
}

ListedCamera list_camera(SystemCalls& system, const std::string& path) {
  auto opened = open_node(system, path);
  if (const auto* const refusal = std::get_if<Refusal>(&opened)) {
    throw SetupError(explain(system, path, *refusal));
  }
  return listed(system, path, std::move(std::get<VideoNode>(opened)));
}

}  // namespace seqloop::live
