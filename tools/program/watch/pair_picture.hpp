// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "program/watch/picture_store.hpp"

namespace seqloop::program {

/// A frame and its place, side by side, or the kept pictures nearest to them. Allocates: yes.
/// @return a JPEG file; empty where there is no picture of one
[[nodiscard]] std::vector<std::uint8_t> pair_picture(const PictureStore& frames,
                                                     std::uint64_t frame,
                                                     const PictureStore& places,
                                                     std::uint64_t place);

}  // namespace seqloop::program
