#pragma once

#include <cstddef>
#include <string>

#include "linux/system_calls.hpp"
#include "linux/video_node.hpp"

namespace seqloop::live {

/// Looks for a camera that was there before: in this order
///  1. whatever a link (/dev/v4l/by-id/...) of the user's leads to, because the user named it;
///  2. the same camera where it was plugged in: driver, card, bus and serial number;
///  3. the same serial number elsewhere, or the same place where either has no number; if only one
///     camera fits;
///  4. the same driver and card elsewhere; if only one camera fits, and it had no twin (`twins`).
/// A serial number that differs is another camera. Allocates: yes.
/// @param path  as the user gave it
/// @param twins cameras that looked the same, this one included, when it was opened first
/// @return a path to open; empty when the camera is not there
[[nodiscard]] std::string find_camera(SystemCalls& system, const std::string& path,
                                      const CameraIdentity& identity, std::size_t twins);

/// How many cameras there are with this driver, card and index of the node.
[[nodiscard]] std::size_t count_twins(SystemCalls& system, const CameraIdentity& identity);

}  // namespace seqloop::live
