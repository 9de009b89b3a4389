// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace seqloop::opencv {

/// Whether a video file says how many frames a second it has. OpenCV does not tell: its backends
/// put 25 there where an AVI file has zeros, and where JPEG pictures follow each other without any
/// container. Other formats are taken at their word.
/// @param head the file's first bytes, as far as its headers reach. Allocates: never
[[nodiscard]] bool tells_frame_rate(std::span<const std::uint8_t> head) noexcept;

}  // namespace seqloop::opencv
