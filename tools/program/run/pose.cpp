// SPDX-License-Identifier: MIT
#include "program/run/pose.hpp"

#include <algorithm>
#include <cmath>

namespace seqloop::program {
namespace {

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;

Quaternion product(const Quaternion& a, const Quaternion& b) noexcept {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

Quaternion inverse(const Quaternion& q) noexcept { return {-q[0], -q[1], -q[2], q[3]}; }

Vector turned(const Quaternion& q, const Vector& v) noexcept {
  const Quaternion all = product(product(q, {v[0], v[1], v[2], 0.0}), inverse(q));
  return {all[0], all[1], all[2]};
}

double dot(const Quaternion& a, const Quaternion& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

}  // namespace

bool make_unit(Quaternion& orientation) noexcept {
  const double length = std::sqrt(dot(orientation, orientation));
  if (!(length > 1e-6) || !std::isfinite(length)) return false;
  for (double& value : orientation) value /= length;
  return true;
}

Pose compose(const Pose& start, const Pose& motion) noexcept {
  Pose pose{turned(start.orientation, motion.position),
            product(start.orientation, motion.orientation)};
  for (std::size_t i = 0; i < 3; ++i) pose.position.at(i) += start.position.at(i);
  static_cast<void>(make_unit(pose.orientation));
  return pose;
}

Pose motion(const Pose& from, const Pose& to) noexcept {
  Vector way{};
  for (std::size_t i = 0; i < 3; ++i) way.at(i) = to.position.at(i) - from.position.at(i);
  const Quaternion back = inverse(from.orientation);
  return {turned(back, way), product(back, to.orientation)};
}

Pose between(const Pose& one, const Pose& other, double share) noexcept {
  Pose pose;
  for (std::size_t i = 0; i < 3; ++i)
    pose.position.at(i) = one.position.at(i) + share * (other.position.at(i) - one.position.at(i));
  const double cosine = dot(one.orientation, other.orientation);
  const double sign = cosine < 0.0 ? -1.0 : 1.0;
  const double angle = std::acos(std::min(std::abs(cosine), 1.0));
  // Of a small angle, the sines' quotient is the share itself.
  const bool small = angle < 1e-6;
  const double a = small ? 1.0 - share : std::sin((1.0 - share) * angle) / std::sin(angle);
  const double b = sign * (small ? share : std::sin(share * angle) / std::sin(angle));
  for (std::size_t i = 0; i < 4; ++i)
    pose.orientation.at(i) = a * one.orientation.at(i) + b * other.orientation.at(i);
  static_cast<void>(make_unit(pose.orientation));
  return pose;
}

double metres(const Pose& motion) noexcept {
  return std::hypot(motion.position[0], motion.position[1], motion.position[2]);
}

}  // namespace seqloop::program
