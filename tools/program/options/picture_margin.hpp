// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/picture_needs.hpp"

namespace seqloop::program {

/// The size at which a camera's pictures are asked for and decoded: four times what the describer
/// brings them to, but no more than 640x480 unless it needs more. Then a camera sees a place as a
/// recording does: of 180 answers on Gardens Point (ds 20, MJPG, built-in descriptor), 10 are
/// others than with whole pictures at the very size, 8 at twice, 2 at four times the size.
[[nodiscard]] PictureNeeds with_margin(const PictureNeeds& needs);

}  // namespace seqloop::program
