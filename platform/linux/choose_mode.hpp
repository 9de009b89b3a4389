// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "seqloop/linux/camera_mode.hpp"

namespace seqloop::live {

/// Whether frames of this format and size can be used at all: in colour where that is needed, and
/// as the user insists.
[[nodiscard]] bool serves(const CameraMode& mode, const CameraWish& wish) noexcept;

/// Bytes that a second of this mode makes a processor touch, from the camera's memory to a picture:
///
///     pixels x frames a second x weight of the format
///
/// | weight | GREY | NV12, YU12 | YUYV, UYVY | BGR3 | RGB3 | MJPG |
/// |---|---|---|---|---|---|---|
/// | grey is enough | 1 | 1.25 | 2 | 3 | 3 | 12 |
/// | colour is needed | - | 8 | 7 | 3 | 6 | 20 |
///
/// Grey lies in the first plane of NV12, and in every second byte of YUYV. BGR3 is used as it is,
/// the other colours are converted, which weighs more than bytes. MJPG is decoded at 1/2, 1/4 or
/// 1/8 where that is still as large as wished: then 0.4 of its weight stays (the bits have to be
/// read), and 0.6 shrinks with the pixels. The weights order formats; they are no times. An unknown
/// rate counts as the wished one.
[[nodiscard]] double cost(const CameraMode& mode, const CameraWish& wish) noexcept;

/// The modes that serve, the one to try first in front:
///  1. those that are fast enough (2 % less counts: 29.97 is 30), the others by falling rate. A
///     place passed between two frames is lost; a small picture is only blurred when it is brought
///     to the descriptor's size, so the rate goes before the size;
///  2. those that are large enough in both directions, the others by falling size;
///  3. the cheapest: of equal formats the smallest size and the lowest rate.
/// Modes that are equally good stay in the driver's order. Work: n log n. Allocates: the result.
[[nodiscard]] std::vector<CameraMode> choose_mode(const std::vector<CameraMode>& modes,
                                                  const CameraWish& wish);

}  // namespace seqloop::live
