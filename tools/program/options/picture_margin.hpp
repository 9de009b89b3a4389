// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/picture_needs.hpp"

namespace seqloop::program {

/// The size at which a camera's pictures are asked for and decoded: twice what the describer brings
/// them to, but no more than 640x480 unless it needs more. Then a camera sees a place as a
/// recording does, whose pictures are decoded whole.
[[nodiscard]] PictureNeeds with_margin(const PictureNeeds& needs);

}  // namespace seqloop::program
