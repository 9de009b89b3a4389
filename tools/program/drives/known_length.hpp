// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "seqloop/frame_source.hpp"

namespace seqloop::program {

/// Frames of the drive; nothing where that is not sure: what a video declares may be too few.
[[nodiscard]] std::optional<std::uint64_t> known_length(const FrameSource& drive);

}  // namespace seqloop::program
