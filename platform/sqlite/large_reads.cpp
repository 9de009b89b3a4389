// SPDX-License-Identifier: MIT
#include "sqlite/large_reads.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace seqloop::sqlite {
namespace {

// SQLite may look this far beyond a page that is damaged.
constexpr std::size_t beyond = 256;

// So much of a piece is read page by page before all of it is: where blocks of many sessions lie
// between each other, the rest would be read for nothing.
constexpr std::int64_t worth_it = std::int64_t{64} << 10;

}  // namespace

LargeReads::LargeReads(const Database& database) : database_(database) {
  sqlite3_file* file = nullptr;
  const int code =
      sqlite3_file_control(database.handle(), "main", SQLITE_FCNTL_FILE_POINTER, &file);
  if (code != SQLITE_OK || file == nullptr || file->pMethods == nullptr) return;
  // Files of an earlier version have none of this: a test's, for one.
  constexpr int fetching = 3;
  if (file->pMethods->iVersion < fetching) return;
  sqlite3_int64 size = 0;
  if (file->pMethods->xFileSize(file, &size) != SQLITE_OK) return;
  file_ = file;
  file_size_ = size;
  before_ = file->pMethods;
  static_cast<sqlite3_io_methods&>(methods_) = *before_;
  methods_.owner = this;
  methods_.xFetch = [](sqlite3_file* self, sqlite3_int64 at, int wanted, void** page) {
    *page = of(self).fetch(at, wanted);
    return SQLITE_OK;
  };
  methods_.xUnfetch = [](sqlite3_file* self, sqlite3_int64, void* page) {
    of(self).release(page);
    return SQLITE_OK;
  };
  // Nothing is mapped: SQLite's file is not told.
  methods_.xFileControl = [](sqlite3_file* self, int what, void* value) {
    if (what == SQLITE_FCNTL_MMAP_SIZE) return SQLITE_NOTFOUND;
    return of(self).before_->xFileControl(self, what, value);
  };
  file_->pMethods = &methods_;
  sqlite3_exec(database_.handle(), "PRAGMA mmap_size = 1", nullptr, nullptr, nullptr);
}

LargeReads::~LargeReads() {
  if (file_ == nullptr) return;
  sqlite3_exec(database_.handle(), "PRAGMA mmap_size = 0", nullptr, nullptr, nullptr);
  file_->pMethods = before_;
}

/// @return a page; null: SQLite shall read it itself
std::byte* LargeReads::fetch(std::int64_t at, std::int64_t size) noexcept {
  const std::int64_t number = at / piece_bytes;
  const std::int64_t first = at % piece_bytes;
  Piece* piece = piece_with(number);
  if (piece == nullptr) {
    if (number != std::exchange(missed_, number)) missed_bytes_ = 0;
    missed_bytes_ += size;
    const bool goes_on = number == newest_ + 1 && given_ >= piece_bytes / 2;
    if (!goes_on && missed_bytes_ <= worth_it) return nullptr;
    piece = read(number);
  }
  if (piece == nullptr || first + size > piece->size) return nullptr;
  if (number == newest_) given_ += size;
  piece->last_used = ++uses_;
  ++piece->pages_used;
  return &piece->bytes[static_cast<std::size_t>(first)];
}

/// @param page null: SQLite wants nothing mapped any more
void LargeReads::release(const void* page) noexcept {
  if (page == nullptr) return;
  for (Piece& piece : pieces_) {
    const std::byte* const begin = piece.bytes.get();
    if (begin == nullptr || page < begin || page >= begin + piece_bytes) continue;
    --piece.pages_used;
    return;
  }
}

LargeReads::Piece* LargeReads::piece_with(std::int64_t number) noexcept {
  const auto found = std::ranges::find(pieces_, number, &Piece::number);
  return found == pieces_.end() ? nullptr : &*found;
}

/// Reads a piece to where one lies that is used no more.
/// @return null: all are used, or the disk fails, which SQLite is to find out by itself
LargeReads::Piece* LargeReads::read(std::int64_t number) noexcept {
  Piece* room = nullptr;
  for (Piece& piece : pieces_) {
    if (piece.pages_used > 0) continue;
    if (room == nullptr || piece.last_used < room->last_used) room = &piece;
  }
  if (room == nullptr) return nullptr;
  room->number = none;
  if (!room->bytes) {
    room->bytes.reset(new (std::nothrow) std::byte[static_cast<std::size_t>(piece_bytes) + beyond]);
    if (!room->bytes) return nullptr;
  }
  const std::int64_t at = number * piece_bytes;
  const std::int64_t size = std::min(piece_bytes, file_size_ - at);
  if (size <= 0 ||
      before_->xRead(file_, room->bytes.get(), static_cast<int>(size), at) != SQLITE_OK) {
    return nullptr;
  }
  room->number = number;
  room->size = size;
  newest_ = number;
  given_ = 0;
  return room;
}

}  // namespace seqloop::sqlite
