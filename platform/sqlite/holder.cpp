// SPDX-License-Identifier: MIT
#include "sqlite/holder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

namespace seqloop::sqlite {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

std::string holder_of(const std::filesystem::path& path) {
  try {
    Database database(path, SQLITE_OPEN_READONLY);
    Statement row(database, "SELECT pid, host FROM holder");
    if (row.step()) {
      return "process " + std::to_string(row.integer(0)) + " on " + row.text(1) + " writes it";
    }
  } catch (const DatabaseError&) {  // it has hardly begun
  }
  return "another process writes it";
}

}  // namespace

Holder::Holder(const std::filesystem::path& path) {
  const std::string name = path.string();
  // Who made the file may remove it again before it is locked here.
  do {
    made_ = open(path, O_EXCL);
    if (!made_ && !(errno == EEXIST && open(path, 0))) {
      throw SetupError(
          {name, "cannot be opened to write: " + std::string(std::strerror(errno)),
           errno == ENOSPC ? "make room" : "look at the rights of the file and its folder"});
    }
    struct stat status {};
    const bool file = ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
    // A file system without locks has none for anybody else either.
    const bool held = file && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (file && !held) continue;
    ::close(std::exchange(descriptor_, -1));
    if (!file) throw SetupError({name, "is no file", "name a map, or one that is to become one"});
    throw SetupError({name, holder_of(path),
                      "wait until it ends; meanwhile `run` and `match` can read it (--read-only)"});
  } while (!is_at(path));
}

bool Holder::open(const std::filesystem::path& path, int more) noexcept {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | more, 0666);
  return descriptor_ >= 0;
}

bool Holder::is_at(const std::filesystem::path& path) const noexcept {
  struct stat own {};
  struct stat there {};
  return ::fstat(descriptor_, &own) == 0 && ::stat(path.c_str(), &there) == 0 &&
         own.st_dev == there.st_dev && own.st_ino == there.st_ino;
}

void Holder::remove_made(const std::filesystem::path& path) const noexcept {
  if (made_ && is_at(path)) ::unlink(path.c_str());
}

Holder::Holder(Holder&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), made_(other.made_) {}

Holder::~Holder() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void sign(Database& database) {
  Statement(database, "INSERT OR REPLACE INTO holder VALUES(1, ?, ?)")
      .with(static_cast<std::int64_t>(::getpid()), std::string_view(host_name()))
      .run();
}

}  // namespace seqloop::sqlite
