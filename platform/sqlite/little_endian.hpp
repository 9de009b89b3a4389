// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop::sqlite {

/// @param bytes 8 or more, the lowest first
[[nodiscard]] inline std::uint64_t load_u64(std::span<const std::byte> bytes) noexcept {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) value |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
  return value;
}

inline void store_u64(std::uint64_t value, std::span<std::byte> bytes) noexcept {
  for (unsigned i = 0; i < 8; ++i) bytes[i] = static_cast<std::byte>((value >> (8 * i)) & 0xFFU);
}

}  // namespace seqloop::sqlite
