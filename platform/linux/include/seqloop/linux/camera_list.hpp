// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "seqloop/linux/camera_controls.hpp"
#include "seqloop/linux/camera_mode.hpp"
#include "seqloop/linux/detail/video_node.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// One /dev/video*, camera or not.
struct ListedCamera {
  std::string path;
  std::vector<std::string> links;  ///< under /dev/v4l, which stay when numbers change
  CameraIdentity identity;         ///< empty where the device could not be asked
  std::string fault;               ///< why it is no camera for us; empty where it is one
  CameraOffer offer;
  std::vector<CameraControl> controls;
};

/// Every /dev/video*, by number, with what it says of itself. Starts nothing: a camera that is in
/// use is listed too. Allocates: yes.
[[nodiscard]] std::vector<ListedCamera> list_cameras(SystemCalls& system);

/// One of them. Throws SetupError where it is no camera.
[[nodiscard]] ListedCamera list_camera(SystemCalls& system, const std::string& path);

}  // namespace seqloop::live
