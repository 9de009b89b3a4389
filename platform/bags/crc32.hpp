// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop::bags {

/// The check sum of MCAP: CRC-32 as in zlib and Ethernet.
class Crc32 {
 public:
  void add(std::span<const std::uint8_t> bytes) noexcept {
    std::uint32_t crc = value_;
    // Eight bytes at a time ("slicing by 8"): a picture in a tenth of the time of byte by byte.
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
      crc ^= word(bytes);
      const std::uint32_t next = word(bytes.subspan(4));
      crc = tables[7][crc & 255U] ^ tables[6][crc >> 8U & 255U] ^ tables[5][crc >> 16U & 255U] ^
            tables[4][crc >> 24U] ^ tables[3][next & 255U] ^ tables[2][next >> 8U & 255U] ^
            tables[1][next >> 16U & 255U] ^ tables[0][next >> 24U];
    }
    for (const std::uint8_t byte : bytes) crc = tables[0][(crc ^ byte) & 255U] ^ crc >> 8U;
    value_ = crc;
  }

  [[nodiscard]] std::uint32_t value() const noexcept { return ~value_; }

 private:
  using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

  static std::uint32_t word(std::span<const std::uint8_t> bytes) noexcept {
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U |
           static_cast<std::uint32_t>(bytes[2]) << 16U |
           static_cast<std::uint32_t>(bytes[3]) << 24U;
  }

  static constexpr Tables make_tables() noexcept {
    constexpr std::uint32_t polynomial = 0xedb88320U;
    Tables made{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      std::uint32_t crc = byte;
      for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1U ^ polynomial : crc >> 1U;
      made[0][byte] = crc;
    }
    for (std::size_t table = 1; table < made.size(); ++table)
      for (std::size_t byte = 0; byte < 256; ++byte) {
        const std::uint32_t before = made[table - 1][byte];
        made[table][byte] = made[0][before & 255U] ^ before >> 8U;
      }
    return made;
  }

  static const Tables tables;
  std::uint32_t value_ = 0xffffffffU;
};

inline constexpr Crc32::Tables Crc32::tables = Crc32::make_tables();

}  // namespace seqloop::bags
