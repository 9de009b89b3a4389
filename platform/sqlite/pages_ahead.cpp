// SPDX-License-Identifier: MIT
#include "sqlite/pages_ahead.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <new>
#include <utility>

namespace seqloop::sqlite {
namespace {

// Smaller files are read before a thread is worth its while.
constexpr std::uint64_t least_bytes = std::uint64_t{16} << 20U;

constexpr const char* few_pages = "PRAGMA cache_size = 16";
constexpr const char* as_ever = "PRAGMA cache_size = -2000";  // SQLite's own choice, in KB

/// The open file of a connection, if it still is the one of its name.
sqlite3_file* file_of(const Database& database) noexcept {
  int moved = 0;
  sqlite3_file* file = nullptr;
  const auto ask = [&](int what, void* answer) {
    return sqlite3_file_control(database.handle(), "main", what, answer) == SQLITE_OK;
  };
  if (!ask(SQLITE_FCNTL_FILE_POINTER, &file) || file == nullptr || file->pMethods == nullptr) {
    return nullptr;
  }
  return ask(SQLITE_FCNTL_HAS_MOVED, &moved) && moved == 0 ? file : nullptr;
}

}  // namespace

UncachedFile::UncachedFile(const std::filesystem::path& path) noexcept {
  try {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return;
    const auto bytes = static_cast<std::uint64_t>(status.st_size);
    if (bytes < least_bytes) return;
    static std::mutex mutex;
    static std::map<std::pair<dev_t, ino_t>, int> open;
    const std::scoped_lock lock(mutex);
    const auto [known, first] = open.try_emplace({status.st_dev, status.st_ino}, -1);
    if (first) known->second = ::open(path.c_str(), O_RDONLY | O_DIRECT | O_CLOEXEC);
    descriptor_ = known->second;
    if (descriptor_ < 0) return;
    bytes_ = bytes;
    if (bytes > std::numeric_limits<std::size_t>::max()) return;
    // Never looked into. Mapped once: each time would wait for threads that take memory.
    void* const mapped =
        ::mmap(nullptr, static_cast<std::size_t>(bytes), PROT_NONE, MAP_SHARED, descriptor_, 0);
    if (mapped == MAP_FAILED) return;
    mapped_ = {static_cast<std::byte*>(mapped), static_cast<std::size_t>(bytes)};
  } catch (const std::bad_alloc&) {  // then it is read as ever
  }
}

UncachedFile::~UncachedFile() {
  if (!mapped_.empty()) ::munmap(mapped_.data(), mapped_.size());
}

std::size_t UncachedFile::read(std::uint64_t at, std::span<std::byte> to) const noexcept {
  ::fcntl(descriptor_, F_SETFL, cached(at, to.size()) ? 0 : O_DIRECT);
  for (;;) {
    const ssize_t bytes = ::pread(descriptor_, to.data(), to.size(), static_cast<off_t>(at));
    if (bytes >= 0) return static_cast<std::size_t>(bytes);
    if (errno != EINTR) return 0;
  }
}

/// Whether most of a piece is in the system's cache; where that is not told to everybody, it is.
bool UncachedFile::cached(std::uint64_t at, std::size_t bytes) const noexcept {
  if (at >= mapped_.size()) return false;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::array<unsigned char, 1024> there{};
  const std::span<std::byte> piece = mapped_.subspan(static_cast<std::size_t>(at));
  const std::size_t pages =
      std::min({there.size(), bytes / page, (piece.size() + page - 1) / page});
  if (::mincore(piece.data(), pages * page, there.data()) != 0) return false;
  const auto in_cache =
      std::count_if(there.begin(), there.begin() + static_cast<std::ptrdiff_t>(pages),
                    [](unsigned char state) { return (state & 1U) != 0; });
  return static_cast<std::size_t>(in_cache) > pages / 2;
}

PagesAhead::PagesAhead(const Database& database, const std::filesystem::path& path) : from_(path) {
  if (from_.bytes() == 0) return;
  file_ = file_of(database);
  if (file_ == nullptr) return;
  memory_ =
      std::make_unique_for_overwrite<std::byte[]>(pieces * piece_bytes + UncachedFile::alignment);
  void* begin = memory_.get();
  std::size_t room = pieces * piece_bytes + UncachedFile::alignment;
  begin = std::align(UncachedFile::alignment, pieces * piece_bytes, begin, room);
  const std::span all(static_cast<std::byte*>(begin), pieces * piece_bytes);
  for (std::size_t i = 0; i < pieces; ++i)
    held_[i].room = all.subspan(i * piece_bytes, piece_bytes);
  own_ = file_->pMethods;
  static_cast<sqlite3_io_methods&>(methods_) = *own_;
  methods_.xRead = read;
  methods_.self = this;
  file_->pMethods = &methods_;
  // What SQLite's own cache grows by, a page at a time, is asked of the system, and waits for
  // threads that take memory.
  connection_ = database.handle();
  sqlite3_exec(connection_, few_pages, nullptr, nullptr, nullptr);
}

PagesAhead::~PagesAhead() {
  if (file_ != nullptr) {
    file_->pMethods = own_;
    sqlite3_exec(connection_, as_ever, nullptr, nullptr, nullptr);
  }
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    unwanted_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

int PagesAhead::read(sqlite3_file* file, void* to, int bytes, sqlite3_int64 at) noexcept {
  PagesAhead& self = *static_cast<const Methods*>(file->pMethods)->self;
  const std::span page(static_cast<std::byte*>(to), static_cast<std::size_t>(bytes));
  if (self.take(static_cast<std::uint64_t>(at), page)) return SQLITE_OK;
  return self.own_->xRead(file, to, bytes, at);
}

/// @return whether the page was here, or was waited for
bool PagesAhead::take(std::uint64_t at, std::span<std::byte> to) noexcept {
  // What is less than a page is asked for to see whether the file has changed.
  if (to.size() < 512 || at + to.size() > from_.bytes()) return false;
  const std::uint64_t number = at / piece_bytes;
  std::unique_lock lock(mutex_);
  if (!move_to(number)) return false;
  Piece& wanted = piece(number);
  changed_.wait(lock, [&] { return wanted.number == number; });
  const auto begin = static_cast<std::size_t>(at % piece_bytes);
  if (begin + to.size() > wanted.bytes) return false;
  std::memcpy(to.data(), wanted.room.data() + begin, to.size());
  given_ += to.size();
  return true;
}

/// Keeps the thread some pieces ahead of this one. @return whether it is among them
bool PagesAhead::move_to(std::uint64_t number) noexcept {
  if (number < first_) return false;
  if (number >= first_ + pieces) {
    // A file whose pages are in no order is read as ever.
    if (thread_.joinable() && given_ - leapt_at_ < piece_bytes) return false;
    leapt_at_ = given_;
    first_ = next_ = number;
  } else if (number <= first_ + 1) {
    if (thread_.joinable()) return true;
  } else {
    first_ = number - 1;  // rows begin in the one and go on in the other
  }
  changed_.notify_all();
  if (!thread_.joinable()) {
    try {
      thread_ = std::thread([this] { fill(); });
    } catch (...) {
      return false;
    }
  }
  return true;
}

void PagesAhead::fill() noexcept {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] {
      return unwanted_ || (next_ < first_ + pieces && next_ * piece_bytes < from_.bytes());
    });
    if (unwanted_) return;
    const std::uint64_t number = next_++;
    Piece& filled = piece(number);
    filled.number = none;
    lock.unlock();
    const std::size_t bytes = from_.read(number * piece_bytes, filled.room);
    lock.lock();
    filled.bytes = bytes;
    filled.number = number;
    changed_.notify_all();
  }
}

}  // namespace seqloop::sqlite
