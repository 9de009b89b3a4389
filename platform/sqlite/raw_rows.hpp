// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <vector>

namespace seqloop::sqlite {

/// A column as it stands in a row.
struct RawValue {
  enum class Type : std::uint8_t { null, integer, real, text, blob };
  Type type = Type::null;
  std::int64_t integer = 0;
  double real = 0.0;
  std::span<const std::byte> bytes{};
};

/// Where a row begins in the file.
struct RawPlace {
  std::uint32_t page = 0;
  std::size_t cell = 0;  ///< offset in the page
};

/// The rows of a database file, read without its trees: every page that looks like a leaf of a
/// table is looked at, so that what is whole is found whatever became of the rest. It takes any
/// bytes for rows that can be read as such; checksums have to tell which are.
/// Source: https://www.sqlite.org/fileformat2.html, sections 1.6 and 2.1.
class RawRows {
 public:
  using Take = std::function<void(const RawPlace& place, std::int64_t rowid,
                                  const std::vector<RawValue>& columns)>;

  /// @param page_bytes 512 .. 65536, a power of two
  RawRows(const std::filesystem::path& path, std::size_t page_bytes);

  /// Hands over every row of at most 16 columns, page by page.
  void each(const Take& take);

  /// Reads one again. @return whether it can be read
  bool again(const RawPlace& place, const Take& take);

 private:
  [[nodiscard]] bool load(std::uint32_t number, std::vector<std::byte>& page);
  bool row(const RawPlace& place, const Take& take);

  std::ifstream file_;
  std::size_t size_;
  std::uint64_t pages_;
  std::uint32_t loaded_ = 0;
  std::vector<std::byte> page_;
  std::vector<std::byte> overflow_;
  std::vector<std::byte> payload_;
  std::vector<RawValue> columns_;
};

}  // namespace seqloop::sqlite
