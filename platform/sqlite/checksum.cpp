// SPDX-License-Identifier: MIT
#include "sqlite/checksum.hpp"

#include <zlib.h>

#include <array>
#include <bit>

#include "sqlite/little_endian.hpp"

namespace seqloop::sqlite {

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) noexcept {
  const void* const begin = bytes.data();
  return static_cast<std::uint32_t>(
      ::crc32_z(before, static_cast<const Bytef*>(begin), bytes.size()));
}

RowChecksum& RowChecksum::add(std::int64_t value) noexcept {
  std::array<std::byte, 8> eight{};
  store_u64(std::bit_cast<std::uint64_t>(value), eight);
  bytes(eight);
  return *this;
}

RowChecksum& RowChecksum::add(double value) noexcept {
  return add(std::bit_cast<std::int64_t>(value));
}

RowChecksum& RowChecksum::add(std::span<const std::byte> blob) noexcept {
  add(static_cast<std::int64_t>(blob.size()));
  bytes(blob);
  return *this;
}

}  // namespace seqloop::sqlite
