// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop {

/// What the distance 1 is in fixed point. Unit vectors lie 0 .. 2 apart, 0 .. 65,534. Integers can
/// be added and subtracted in any order with the same sum; those of up to 65,537 frames fit 32
/// bits.
inline constexpr std::uint16_t fixed_distance_one = 32'767;

/// No distance is this: free to mean that there is none.
inline constexpr std::uint16_t no_fixed_distance = 65'535;

/// The Euclidean distance of two quantised descriptors, both scaled to unit length:
/// sqrt(|a|^2 + |b|^2 - 2 dot / (|a| |b|)) with |a| = 0 for a zero vector, otherwise 1; rounded to
/// the nearest 1 / 32,767, halves up. Operations that IEEE 754 defines to the last bit, in one
/// order: the same on every processor. Symmetric; equal vectors are 0 apart, a zero vector and any
/// other 1; the more alike (the larger the dot), the smaller or equal.
/// @param dot        of the two
/// @param inverse_a, inverse_b their `inverse_length`
/// Error against the Euclidean distance of the unit descriptors a and b that were quantised: at
/// most
///   (sqrt(D_a) scale_a + sqrt(D_b) scale_b) / sqrt(2) + 1 / 65,534 + 1e-7, while either's
///   quantising error sqrt(D) * scale / 2 is below 1. Mostly less than a hundredth of that.
[[nodiscard]] std::uint16_t fixed_distance(std::int32_t dot, double inverse_a,
                                           double inverse_b) noexcept;

/// The same for a column.
/// @param dots [count]   @param inverse_query of the query   @param inverse_rows [count]
/// @param out  [count] written
/// Work: a square root a row. Allocates: never.
void fixed_distances(std::span<const std::int32_t> dots, double inverse_query,
                     std::span<const double> inverse_rows, std::span<std::uint16_t> out) noexcept;

}  // namespace seqloop
