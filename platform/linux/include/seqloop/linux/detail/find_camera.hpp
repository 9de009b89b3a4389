// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "seqloop/linux/detail/video_node.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// Cameras that look the same, the one in question included.
struct Twins {
  std::size_t kind = 1;    ///< same driver, card and index of the node
  std::size_t serial = 1;  ///< of those, with the same serial number, or none as well
};

/// How many cameras look like this one.
/// @param path as the user gave it
[[nodiscard]] Twins count_twins(SystemCalls& system, const std::string& path,
                                const CameraIdentity& identity);

/// Looks for a camera that was there before: in this order
///  1. whatever a link (/dev/v4l/by-id/...) of the user's leads to, because the user named it;
///  2. the same camera where it was plugged in: driver, card, bus and serial number;
///  3. the same serial number elsewhere, or the same place where either has no number; if only one
///     camera fits, and no other had that number (cheap cameras all have one);
///  4. the same driver and card elsewhere; if only one camera fits, and there was no other of them.
/// A serial number that differs is another camera. Looked at are `/dev/videoN` and `path` itself,
/// whatever it is called. Allocates: yes.
/// @param path  as the user gave it
/// @param twins as they were when it was opened first
/// @return a path to open; empty when the camera is not there
[[nodiscard]] std::string find_camera(SystemCalls& system, const std::string& path,
                                      const CameraIdentity& identity, const Twins& twins);

}  // namespace seqloop::live
