// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "seqloop/linux/camera_mode.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// Asks an open camera for everything that it offers: formats, sizes and rates.
///
/// Where the driver gives a range instead of a list, modes are made of the size that is nearest to
/// the wished one (at least as large, where it can be) and the largest, and of the wished rate and
/// the fastest. A driver that knows no list of sizes is asked what the wished size would become,
/// and one that knows no rates gets modes without.
/// Errors: a list that breaks off is taken as far as it goes. Allocates: yes.
/// @param type single-planar or multi-planar capture
[[nodiscard]] CameraOffer read_offer(SystemCalls& system, int fd, std::uint32_t type,
                                     const CameraWish& wish);

}  // namespace seqloop::live
