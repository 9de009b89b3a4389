// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace seqloop::sqlite {

/// CRC-32 as zlib, PNG and Ethernet compute it, so that anyone can check it with what there is.
/// @param before that of the bytes before these; 0 where there are none
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes,
                                  std::uint32_t before = 0) noexcept;

/// The checksum of a row: the name of its table and its columns one after another. Integers and
/// real numbers are 8 bytes, little-endian; texts and blobs are their bytes, their length before.
class RowChecksum {
 public:
  explicit RowChecksum(std::string_view table) noexcept { bytes(std::as_bytes(std::span(table))); }

  RowChecksum& add(std::int64_t value) noexcept;
  RowChecksum& add(double value) noexcept;
  RowChecksum& add(std::string_view text) noexcept { return add(std::as_bytes(std::span(text))); }
  RowChecksum& add(std::span<const std::byte> blob) noexcept;

  [[nodiscard]] std::int64_t value() const noexcept { return crc_; }

 private:
  void bytes(std::span<const std::byte> more) noexcept { crc_ = crc32(more, crc_); }

  std::uint32_t crc_ = 0;
};

/// @return the checksum of a row of this table with these columns
template <class... Columns>
[[nodiscard]] std::int64_t row_checksum(std::string_view table,
                                        const Columns&... columns) noexcept {
  RowChecksum sum(table);
  (sum.add(columns), ...);
  return sum.value();
}

}  // namespace seqloop::sqlite
