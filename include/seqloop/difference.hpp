// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// Descriptors are stored in rows of a whole number of these, the rest zero, so that a kernel has
/// no tail.
inline constexpr std::size_t lanes = 16;

/// Values that one stored descriptor takes: D rounded up to whole lanes.
[[nodiscard]] constexpr std::size_t padded_size(std::size_t descriptor_size) noexcept {
  return (descriptor_size + lanes - 1) / lanes * lanes;
}

/// A dot product has a sum for every eighth value, added up as floats over 64 of these each.
inline constexpr std::size_t dot_lanes = 8;
inline constexpr std::size_t float_block = 64 * dot_lanes;

/// Dot product, summed in a fixed order, so that the result does not depend on the width of the
/// machine's registers. A product is added by a fused multiply-add, which rounds once: to the same
/// value on every processor, and where a processor has none, by what rounds as it does. Lane by
/// lane, as floats; of lanes 0 to 3 and 4 to 7, (0 + 2) + (1 + 3); these two; and blocks as
/// doubles.
/// @param a, b [S] with S a whole number of lanes
/// @return within 67 * 2^-24 times the sum of |a[i] b[i]| of the exact one, as long as no product
///   is smaller than floats can hold
/// Work: S fused multiply-adds. Allocates: never.
[[nodiscard]] double dot(std::span<const float> a, std::span<const float> b) noexcept;

/// Euclidean distance, summed in double in a fixed order.
/// @param a, b [D]
/// @return 0 .. 2 for unit vectors
/// Work: 2 D additions, D multiplications. Allocates: never. Paper: Algorithm 2.
[[nodiscard]] float euclidean(std::span<const float> a, std::span<const float> b) noexcept;

/// The same from dot products, as maps are searched by it: |a|^2 + |b|^2 - 2ab.
/// @param aa, bb, ab each as by `dot`
/// @return for unit vectors, its square is within 1.6e-5 of the exact one, usually within 2e-7;
///   exactly 0 where they are equal
[[nodiscard]] float euclidean(double aa, double bb, double ab) noexcept;

/// Mean absolute difference, summed in a fixed order.
/// @param a, b [S] with S a whole number of lanes   @param size D, what the mean is over
/// Work: S subtractions and adds. Allocates: never. Source: SeqSLAM.
[[nodiscard]] float mean_absolute(std::span<const float> a, std::span<const float> b,
                                  std::size_t size) noexcept;

/// The one or the other, of two descriptors.
[[nodiscard]] float difference(Difference kind, std::span<const float> a, std::span<const float> b,
                               std::size_t size) noexcept;

/// Whether a descriptor says nothing about its picture, so that all such frames would look alike:
/// all zero, or, where pictures are compared (mean absolute), all of one value.
[[nodiscard]] bool blank(Difference kind, std::span<const float> descriptor) noexcept;

/// Whether no value is infinite or NaN. Work: looks at all values, side by side.
[[nodiscard]] bool all_finite(std::span<const float> values) noexcept;

/// Sum of the squares of what they differ by. @param a, b [n]. Work: n. Allocates: never.
[[nodiscard]] double squared_distance(std::span<const float> a, std::span<const float> b) noexcept;

/// Sum of the squares. NaN or infinite when a value is; zero only when all are.
[[nodiscard]] double squared_norm(std::span<const float> vector) noexcept;

/// Divides by the L2 norm. A zero vector, and one with NaN or infinity in it, stays as it is.
/// @return whether it was divided. Paper: Algorithm 1.
bool normalise(std::span<float> vector) noexcept;

}  // namespace seqloop
