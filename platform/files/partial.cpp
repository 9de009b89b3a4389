// SPDX-License-Identifier: MIT
#include "files/partial.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <string_view>

#include "seqloop/files/output_file.hpp"

namespace seqloop::files {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = ".partial-";

/// Whether a name is `.NAME.partial-PID` or `.NAME.partial-PID-N`. @param output NAME; empty: any
bool is_partial(std::string_view name, std::string_view output) {
  const std::size_t end = name.rfind(mark);
  if (!name.starts_with('.') || end == std::string_view::npos || end < 2) return false;
  if (!output.empty() && name.substr(1, end - 1) != output) return false;
  std::string_view numbers = name.substr(end + mark.size());
  const auto take_number = [&numbers] {
    const std::size_t digits = std::min(numbers.find_first_not_of("0123456789"), numbers.size());
    numbers.remove_prefix(digits);
    return digits > 0;
  };
  if (!take_number()) return false;
  if (numbers.empty()) return true;
  if (!numbers.starts_with('-')) return false;
  numbers.remove_prefix(1);
  return take_number() && numbers.empty();
}

/// Whether the name still means what was opened.
bool is_named(int descriptor, const fs::path& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::lstat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

void remove_if_abandoned(const fs::path& path, PartialKind kind) {
  const bool folder = kind == PartialKind::folder;
  const int descriptor =
      ::open(path.c_str(),
             (folder ? O_RDONLY | O_DIRECTORY : O_WRONLY | O_NONBLOCK) | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status {};
  const bool is_kind = ::fstat(descriptor, &status) == 0 &&
                       (folder ? S_ISDIR(status.st_mode) : S_ISREG(status.st_mode));
  if (is_kind && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && is_named(descriptor, path)) {
    std::error_code error;
    fs::remove_all(path, error);
  }
  ::close(descriptor);
}

/// @param output the name of one; empty: all
void remove_abandoned(const fs::path& folder, std::string_view output, PartialKind kind) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (is_partial(name, output)) remove_if_abandoned(entry->path(), kind);
  }
}

int make(const fs::path& path, PartialKind kind) {
  if (kind == PartialKind::file) {
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  if (::mkdir(path.c_str(), 0777) != 0) return -1;
  return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

}  // namespace

Partial make_partial(const fs::path& output, PartialKind kind) {
  constexpr int most_tries = 100;
  const std::string name = output.filename().string();
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  remove_abandoned(folder, name, kind);
  const std::string stem = "." + name + std::string(mark) + std::to_string(::getpid());
  for (int attempt = 0; attempt < most_tries; ++attempt) {
    const fs::path path = folder / (attempt == 0 ? stem : stem + "-" + std::to_string(attempt));
    const int descriptor = make(path, kind);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) break;
    // A file system without locks has none for whoever would remove it either.
    const bool taken = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!taken && is_named(descriptor, path)) return {path, descriptor};
    ::close(descriptor);  // somebody took it for abandoned before it was locked, and removes it
  }
  return {};
}

void remove_abandoned(const fs::path& folder) { remove_abandoned(folder, {}, PartialKind::file); }

}  // namespace seqloop::files
