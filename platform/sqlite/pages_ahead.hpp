// SPDX-License-Identifier: MIT
#pragma once

#include <sqlite3.h>

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <thread>

#include "sqlite/database.hpp"

namespace seqloop::sqlite {

/// A file that is read past the system's cache: filling that takes longer than what a map read once
/// is read for.
///
/// A process that closes any descriptor of a file loses the locks that SQLite has on it, by
/// whatever connection. So its descriptor stays open until the process ends, and is used again.
class UncachedFile {
 public:
  /// Opens nothing where the file is small.
  explicit UncachedFile(const std::filesystem::path& path) noexcept;
  UncachedFile(const UncachedFile&) = delete;
  UncachedFile& operator=(const UncachedFile&) = delete;
  UncachedFile(UncachedFile&&) = delete;
  UncachedFile& operator=(UncachedFile&&) = delete;
  ~UncachedFile();

  /// Of the file; 0 where it cannot be read this way.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

  /// What the cache has comes from there.
  /// @param at, to begin and end at multiples of `alignment`
  /// @return bytes; 0 at the end, and where they cannot be read
  [[nodiscard]] std::size_t read(std::uint64_t at, std::span<std::byte> to) const noexcept;

  static constexpr std::size_t alignment = 4096;

 private:
  [[nodiscard]] bool cached(std::uint64_t at, std::size_t bytes) const noexcept;

  int descriptor_ = -1;
  std::uint64_t bytes_ = 0;
  std::span<std::byte> mapped_;  // to ask what of it is in the cache
};

/// While it lives, a thread reads a database's file ahead of its connection, megabytes at a time.
/// SQLite asks for page after page: those that are here it gets from here, all others as ever.
///
/// A read transaction must be open, or begin with the first page that is asked for, and end after
/// this: so long no page changes that SQLite takes from the file. Allocates: eight megabytes.
class PagesAhead {
 public:
  /// @param path of the database. Where it cannot be read past the cache, or is small, nothing is
  ///   read ahead.
  PagesAhead(const Database& database, const std::filesystem::path& path);
  PagesAhead(const PagesAhead&) = delete;
  PagesAhead& operator=(const PagesAhead&) = delete;
  PagesAhead(PagesAhead&&) = delete;
  PagesAhead& operator=(PagesAhead&&) = delete;
  ~PagesAhead();

  /// Bytes that the connection got from here.
  [[nodiscard]] std::uint64_t given() const noexcept { return given_; }

 private:
  static constexpr std::size_t piece_bytes = std::size_t{2} << 20U;
  static constexpr std::size_t pieces = 4;
  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();

  /// What SQLite calls in place of the file's own.
  struct Methods : sqlite3_io_methods {
    PagesAhead* self = nullptr;
  };

  struct Piece {
    std::uint64_t number = none;
    std::span<std::byte> room;
    std::size_t bytes = 0;
  };

  static int read(sqlite3_file* file, void* to, int bytes, sqlite3_int64 at) noexcept;
  [[nodiscard]] bool take(std::uint64_t at, std::span<std::byte> to) noexcept;
  [[nodiscard]] bool move_to(std::uint64_t number) noexcept;
  [[nodiscard]] Piece& piece(std::uint64_t number) noexcept {
    return held_[static_cast<std::size_t>(number % pieces)];
  }
  void fill() noexcept;

  UncachedFile from_;
  sqlite3_file* file_ = nullptr;  // null: nothing is read ahead
  const sqlite3_io_methods* own_ = nullptr;
  sqlite3* connection_ = nullptr;
  Methods methods_{};
  std::unique_ptr<std::byte[]> memory_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<Piece, pieces> held_;
  std::uint64_t first_ = 0;  // pieces from this one on are kept
  std::uint64_t next_ = 0;   // is read next
  std::uint64_t given_ = 0;
  std::uint64_t leapt_at_ = 0;  // what was given before the last leap
  bool unwanted_ = false;
  std::thread thread_;  // begins with the first page
};

}  // namespace seqloop::sqlite
