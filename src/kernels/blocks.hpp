// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "seqloop/detail/integer_kernels.hpp"

// What the loops of all variants share: dots.hpp, hamming.hpp and lowest_lines.hpp. A variant
// brings types that do one step of a loop, from its own unnamed namespace, so that what is compiled
// here for its processor stays in its file.
namespace seqloop::kernels {

inline constexpr std::size_t words_per_block = stored_line / sizeof(std::uint64_t);

/// Half a block: what relocalising looks at of a sketch, for which blocks would be half empty.
inline constexpr std::size_t words_per_half = words_per_block / 2;

/// Less than a block of 64 bytes, with zeros behind it.
template <class Owner, class Value>
struct LastBlock {
  LastBlock(const Value* from, std::size_t count) noexcept {
    std::memcpy(values, from, count * sizeof(Value));
  }
  alignas(stored_line) Value values[stored_line / sizeof(Value)] = {};
};

/// Sums that are added up across their lanes together: that costs little more than one.
inline constexpr std::size_t sums_together = 4;

}  // namespace seqloop::kernels
