// SPDX-License-Identifier: MIT
#include "seqloop/detail/fixed_distance.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace seqloop {
namespace {

static_assert(FLT_EVAL_METHOD == 0, "every operation has to round as IEEE 754 says");

std::uint16_t rounded_distance(std::int32_t dot, double inverse_a, double inverse_b) noexcept {
  const double squared_lengths = (inverse_a > 0.0 ? 1.0 : 0.0) + (inverse_b > 0.0 ? 1.0 : 0.0);
  const double cosine = static_cast<double>(dot) * (inverse_a * inverse_b);
  // Rounding may take the cosine of equal vectors a little above 1.
  const double squared = std::max(squared_lengths - 2.0 * cosine, 0.0);
  // Never negative, so that cutting off rounds down. By way of 32 bits, because processors convert
  // to those.
  constexpr double half = 0.5;
  return static_cast<std::uint16_t>(
      static_cast<std::int32_t>(std::sqrt(squared) * fixed_distance_one + half));
}

}  // namespace

std::uint16_t fixed_distance(std::int32_t dot, double inverse_a, double inverse_b) noexcept {
  return rounded_distance(dot, inverse_a, inverse_b);
}

void fixed_distances(std::span<const std::int32_t> dots, double inverse_query,
                     std::span<const double> inverse_rows, std::span<std::uint16_t> out) noexcept {
  for (std::size_t row = 0; row < dots.size(); ++row) {
    out[row] = rounded_distance(dots[row], inverse_query, inverse_rows[row]);
  }
}

}  // namespace seqloop
