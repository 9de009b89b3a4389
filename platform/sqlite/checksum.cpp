// SPDX-License-Identifier: MIT
#include "sqlite/checksum.hpp"

#include <array>
#include <bit>

#include "sqlite/little_endian.hpp"

namespace seqloop::sqlite {
namespace {

constexpr std::size_t at_once = 16;
using Tables = std::array<std::array<std::uint32_t, 256>, at_once>;

/// Table k: what a byte does to the checksum k bytes later.
constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
    tables[0][byte] = crc;
  }
  for (std::size_t k = 1; k < at_once; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t crc = tables[k - 1][byte];
      tables[k][byte] = (crc >> 8U) ^ tables[0][crc & 0xFFU];
    }
  }
  return tables;
}

constexpr Tables tables = make_tables();

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) noexcept {
  std::uint32_t crc = ~before;
  while (bytes.size() >= at_once) {
    const std::uint64_t low = load_u64(bytes) ^ crc;
    const std::uint64_t high = load_u64(bytes.subspan(8));
    crc = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      crc ^= tables[15 - i][(low >> (8 * i)) & 0xFFU] ^ tables[7 - i][(high >> (8 * i)) & 0xFFU];
    }
    bytes = bytes.subspan(at_once);
  }
  for (const std::byte byte : bytes) {
    crc = (crc >> 8U) ^ tables[0][(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~crc;
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
