// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "seqloop/fixed_text.hpp"
#include "seqloop/frame.hpp"

namespace seqloop::turbojpeg {

constexpr std::uint64_t most_pixels = 200'000'000;  // largest camera sensors; 0.6 GB when decoded

/// Bytes that libjpeg may find too many just before a picture's end, beyond those that it has read
/// ahead: some cameras put them there. Of 1,847 damaged pictures whose damage libjpeg sees, 7 pass
/// for padded at 4 bytes and 20 at 16.
constexpr int most_padding = 4;

/// Where a picture goes, row by row without padding.
struct Pixels {
  std::uint8_t* data;  ///< [height, width] grey, or [height, width, 3] B, G, R
  int width;           ///< pixels: the picture's own, or a scaled size of it
  int height;
  PixelFormat format;
};

/// Says that memory does not suffice for a picture of that size.
void set_no_memory(FixedText& fault, int width, int height) noexcept;

/// Decodes a whole JPEG picture and judges whether it is damaged: whether libjpeg warns of anything
/// but padding and header numbers that it makes no use of. It makes up the rest of a picture that
/// it warns of. A picture with such a header is decoded twice, because libjpeg tells its first
/// warning only.
/// @param fault set to why it cannot be decoded; emptied when it can
/// @return whether it could. Allocates: libjpeg does, and frees it all
[[nodiscard]] bool decompress(std::span<const std::uint8_t> jpeg, const Pixels& into,
                              FixedText& fault) noexcept;

}  // namespace seqloop::turbojpeg
