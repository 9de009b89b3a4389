#pragma once

#include <cstddef>
#include <span>

namespace seqloop {

/// Descriptors are stored in rows of a whole number of these, the rest zero, so that a kernel has
/// no tail.
inline constexpr std::size_t lanes = 16;

/// Values that one stored descriptor takes: D rounded up to whole lanes.
[[nodiscard]] constexpr std::size_t padded_size(std::size_t descriptor_size) noexcept {
  return (descriptor_size + lanes - 1) / lanes * lanes;
}

/// Euclidean distance. Summed in a fixed order, so that the result does not depend on the width of
/// the machine's registers, and as squared differences, so that it is exact where vectors are equal
/// (2 - 2ab is not).
/// @param a, b [S] with S a whole number of lanes
/// @return 0 .. 2 for unit vectors
/// Work: S subtractions and MACs. Allocates: never. Paper: Algorithm 2.
[[nodiscard]] float euclidean(std::span<const float> a, std::span<const float> b) noexcept;

/// Sum of the squares. NaN or infinite when a value is; zero only when all are.
[[nodiscard]] double squared_norm(std::span<const float> vector) noexcept;

/// Divides by the L2 norm. A zero vector stays zero.
/// @return whether the vector was longer than zero. Paper: Algorithm 1.
bool normalise(std::span<float> vector) noexcept;

}  // namespace seqloop
