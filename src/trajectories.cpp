// SPDX-License-Identifier: MIT
#include "seqloop/detail/trajectories.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seqloop {

VelocityRange velocity_range(std::size_t ds, double vmin, double vmax) noexcept {
  // 1.1 * 10 is a little above 11 in binary: a bound that is meant to be whole must stay whole.
  constexpr double rounding = 1e-9;
  const auto length = static_cast<double>(ds);
  return {static_cast<std::int64_t>(std::ceil(vmin * length - rounding)),
          static_cast<std::int64_t>(std::floor(vmax * length + rounding))};
}

std::int64_t trajectory_offset(std::int64_t m, std::size_t i, std::size_t ds) noexcept {
  if (ds == 0) return 0;  // a single frame is its own centre
  const auto length = static_cast<std::int64_t>(ds);
  const std::int64_t from_centre = static_cast<std::int64_t>(i) - length / 2;
  const std::int64_t numerator = 2 * m * from_centre + length;
  const std::int64_t denominator = 2 * length;
  const std::int64_t quotient = numerator / denominator;
  return numerator % denominator < 0 ? quotient - 1 : quotient;
}

Trajectories::Trajectories(Arena& arena, std::size_t ds, double vmin, double vmax)
    : ds_(ds),
      range_(velocity_range(ds, vmin, vmax)),
      offsets_(arena.take<std::int32_t>("trajectory offsets",
                                        std::uint64_t{range_.count()} * (ds + 1))) {
  if (arena.measuring()) return;
  for (std::size_t line = 0; line < count(); ++line) {
    for (std::size_t i = 0; i < window(); ++i) {
      offsets_[line * window() + i] = static_cast<std::int32_t>(
          trajectory_offset(range_.first + static_cast<std::int64_t>(line), i, ds));
    }
  }
}

double Trajectories::velocity(std::size_t line) const noexcept {
  if (ds_ == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(range_.first + static_cast<std::int64_t>(line)) /
         static_cast<double>(ds_);
}

}  // namespace seqloop
