// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "seqloop/frame.hpp"

namespace seqloop::turbojpeg {

/// Makes a JPEG file of a picture, colours at half its width and height.
/// @param image at least one pixel   @param quality 1 .. 100
/// @return empty where libjpeg cannot, or the format is none of its values. Work: its pixels.
/// Allocates: yes.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const Image& image, int quality);

}  // namespace seqloop::turbojpeg
