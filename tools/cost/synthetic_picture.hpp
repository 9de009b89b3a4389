// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace seqloop::cost {

/// A JPEG picture of 640x480 in colour, as a camera sends it: the same bytes at every call. It is
/// made of blocks of many sizes with some noise, so that decoding has as much to do as with a
/// street. Throws std::runtime_error where libjpeg-turbo refuses.
[[nodiscard]] std::vector<std::uint8_t> synthetic_jpeg();

inline constexpr int synthetic_width = 640;
inline constexpr int synthetic_height = 480;

}  // namespace seqloop::cost
