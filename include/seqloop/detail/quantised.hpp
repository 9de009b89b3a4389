// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop {

/// What is known of a descriptor that has become one byte a value.
struct Quantised {
  float scale;                ///< a value of the descriptor is about this times its byte
  std::int32_t squared_norm;  ///< of the bytes: 127^2 .. 2^31 - 1, or 0 for the zero vector
};

/// Makes a descriptor small: the largest value becomes 127 or -127, the others are scaled alike and
/// rounded to the nearest integer, halves to the even one. Only additions, multiplications and
/// divisions that IEEE 754 defines to the last bit: the same on every processor.
/// @param descriptor [D] finite, D up to most_small_values
/// @param out        [>= D] -127 .. 127, zero beyond D
/// Error: each value is off by scale / 2 at most, so the vector by sqrt(D) * scale / 2.
/// Work: 3 D. Allocates: never. Source: src/README.md, section 5.2.
Quantised quantise(std::span<const float> descriptor, std::span<std::int8_t> out) noexcept;

/// 1 / length, what `fixed_distance` wants to know of a descriptor; 0 for the zero vector.
/// @param squared_norm of its bytes, from 0
[[nodiscard]] double inverse_length(std::int32_t squared_norm) noexcept;

}  // namespace seqloop
