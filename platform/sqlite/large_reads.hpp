// SPDX-License-Identifier: MIT
#pragma once

#include <sqlite3.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "sqlite/database.hpp"

namespace seqloop::sqlite {

/// While it lives, pages that follow each other in a database's file are read from the disk a
/// quarter of a megabyte at a time, and used where they lie: a map is read whole, and SQLite would
/// ask the system for each page, and copy it. What SQLite has for that, mapping the file into
/// memory, ends the program where the disk fails. Pages that do not follow each other are read one
/// by one.
///
/// One read transaction at most may pass while it lives, since what is read ahead is of its moment;
/// nothing is written through the connection, and one thread uses it. Statements go before it does.
/// Allocates: two megabytes, as they are needed.
class LargeReads {
 public:
  /// @param database where its files are reached otherwise than by SQLite's own ways, nothing
  ///   changes
  explicit LargeReads(const Database& database);
  LargeReads(const LargeReads&) = delete;
  LargeReads& operator=(const LargeReads&) = delete;
  LargeReads(LargeReads&&) = delete;
  LargeReads& operator=(LargeReads&&) = delete;
  ~LargeReads();

 private:
  static constexpr std::int64_t piece_bytes = std::int64_t{1} << 18;
  static constexpr std::int64_t none = -1;

  /// What a file can do, as SQLite has it, and whose it is.
  struct Methods : sqlite3_io_methods {
    LargeReads* owner = nullptr;
  };

  struct Piece {
    std::unique_ptr<std::byte[]> bytes;
    std::int64_t number = none;  ///< pieces of the file before it
    std::int64_t size = 0;       ///< that were read
    int pages_used = 0;
    std::uint64_t last_used = 0;
  };

  static LargeReads& of(const sqlite3_file* file) noexcept {
    return *static_cast<const Methods*>(file->pMethods)->owner;
  }
  [[nodiscard]] std::byte* fetch(std::int64_t at, std::int64_t size) noexcept;
  void release(const void* page) noexcept;
  [[nodiscard]] Piece* piece_with(std::int64_t number) noexcept;
  [[nodiscard]] Piece* read(std::int64_t number) noexcept;

  const Database& database_;
  sqlite3_file* file_ = nullptr;
  const sqlite3_io_methods* before_ = nullptr;
  Methods methods_;
  std::int64_t file_size_ = 0;
  std::int64_t newest_ = none;     // piece that was read last
  std::int64_t given_ = 0;         // bytes of it that were
  std::int64_t missed_ = none;     // piece of the last page that was not there
  std::int64_t missed_bytes_ = 0;  // of it, since another's were
  std::uint64_t uses_ = 0;
  std::array<Piece, 8> pieces_;
};

}  // namespace seqloop::sqlite
