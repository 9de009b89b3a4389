// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "seqloop/linux/camera_mode.hpp"
#include "seqloop/linux/detail/capture_stream.hpp"
#include "seqloop/linux/detail/video_node.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// Opens a camera and lets it run: looks at what it offers, sets the cheapest mode that serves (see
/// `choose_mode`), borrows buffers, starts.
///
/// A mode that the driver refuses, or silently makes another one of, is passed over for the next.
/// When none comes out as it was offered, whatever the driver gives is taken as long as it serves.
/// Errors: the first call that failed, or why there is nothing to be had. Allocates: yes.
/// @param buffers asked for
/// @param most_out pictures that may be out at a time
[[nodiscard]] std::variant<std::unique_ptr<CaptureStream>, Refusal> start_capture(
    SystemCalls& system, const std::string& path, const CameraWish& wish, std::uint32_t buffers,
    std::uint32_t most_out);

}  // namespace seqloop::live
