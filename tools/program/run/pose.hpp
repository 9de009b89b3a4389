// SPDX-License-Identifier: MIT
#pragma once

#include <array>

namespace seqloop::program {

/// A position in metres and an orientation, or the motion from one pose to another. Rigid: no
/// scale.
struct Pose {
  std::array<double, 3> position{};
  std::array<double, 4> orientation{0.0, 0.0, 0.0, 1.0};  ///< unit quaternion x, y, z, w
};

/// The pose that `motion` leads to from `start`.
[[nodiscard]] Pose compose(const Pose& start, const Pose& motion) noexcept;

/// The motion from one pose to another: compose(from, motion(from, to)) is `to`.
[[nodiscard]] Pose motion(const Pose& from, const Pose& to) noexcept;

/// @param share 0: one, 1: other; in between on a straight line, turning evenly the shorter way
[[nodiscard]] Pose between(const Pose& one, const Pose& other, double share) noexcept;

/// Length of a motion's way, as the crow flies.
[[nodiscard]] double metres(const Pose& motion) noexcept;

/// @return false where it has no direction to speak of
[[nodiscard]] bool make_unit(std::array<double, 4>& orientation) noexcept;

}  // namespace seqloop::program
