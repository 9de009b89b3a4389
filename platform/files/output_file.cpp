// SPDX-License-Identifier: MIT
#include "seqloop/files/output_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>
#include <utility>

#include "files/partial.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::files {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{64} * 1024;

/// Nothing is ever created or replaced in the folders in which the kernel shows itself.
bool in_system_folder(const std::filesystem::path& path) {
  std::error_code error;
  const auto folder = std::filesystem::weakly_canonical(path, error).parent_path();
  const auto lies_in = [](const std::filesystem::path& inner, const std::string& outer) {
    return (inner.string() + "/").starts_with(outer + "/");
  };
  return std::ranges::any_of(std::array{path.parent_path(), folder}, [&](const auto& start) {
    if (lies_in(start, "/dev/shm")) return false;  // memory for everybody's files
    return lies_in(start, "/dev") || lies_in(start, "/proc") || lies_in(start, "/sys");
  });
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)), buffer_(buffer_bytes) {
  if (path_.empty() || !path_.has_filename())
    throw SetupError(
        Fault{"output file '" + path_.string() + "'", "names no file", "give a file name"});
  const std::string shown = path_.string();
  if (shown == "-" || shown == "/dev/stdout") {
    descriptor_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    if (descriptor_ < 0) throw SetupError(Fault{"standard output", reason(errno)});
    return;
  }
  // The status comes first, and through all links: what a link in /dev or /proc leads to has no
  // name that could be renamed over.
  std::error_code error;
  const auto status = std::filesystem::status(path_, error);
  if (std::filesystem::is_directory(status))
    throw SetupError(Fault{shown, "is a folder", "give the name of a file"});
  const bool exists = std::filesystem::exists(status);
  if (in_system_folder(path_) || (exists && !std::filesystem::is_regular_file(status))) {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0)
      throw SetupError(Fault{shown, "cannot be opened for writing: " + reason(errno)});
    return;
  }
  if (!exists && std::filesystem::is_symlink(path_, error))
    throw SetupError(Fault{shown, "is a link that leads nowhere", "remove it"});
  if (std::filesystem::is_symlink(path_, error)) {
    const auto target = std::filesystem::weakly_canonical(path_, error);
    if (!error) path_ = target;
  }
  // Renaming would replace a file that its owner has protected.
  if (exists && ::access(path_.c_str(), W_OK) != 0)
    throw SetupError(Fault{shown, "exists and may not be written: " + reason(errno),
                           "choose another name or change its permissions"});
  open_beside();
  // What replaces a file is as private as the file was.
  struct stat before {};
  if (exists && ::stat(path_.c_str(), &before) == 0)
    (void)::fchmod(descriptor_, before.st_mode & 07777U);
}

void OutputFile::open_beside() {
  auto folder = path_.parent_path();
  if (folder.empty()) folder = ".";
  std::error_code error;
  if (!std::filesystem::exists(folder, error))
    throw SetupError(missing_folder(path_.string(), folder));
  if (!std::filesystem::is_directory(folder, error))
    throw SetupError(Fault{path_.string(), folder.string() + " is not a folder"});

  Partial made = make_partial(path_, PartialKind::file);
  if (made.descriptor < 0)
    throw SetupError(Fault{path_.string(), "cannot be created: " + reason(errno),
                           "choose a folder that may be written"});
  partial_ = std::move(made.path);
  descriptor_ = made.descriptor;
}

bool OutputFile::rewindable() const noexcept {
  const int flags = ::fcntl(descriptor_, F_GETFL);
  return ::lseek(descriptor_, 0, SEEK_CUR) == 0 && flags >= 0 && (flags & O_APPEND) == 0;
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  if (!partial_.empty()) ::unlink(partial_.c_str());
  ::close(descriptor_);
}

void OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (buffered_ == buffer_.size()) flush();
    const std::size_t count = std::min(bytes.size(), buffer_.size() - buffered_);
    std::memcpy(buffer_.data() + buffered_, bytes.data(), count);
    buffered_ += count;
    bytes = bytes.subspan(count);
  }
}

void OutputFile::overwrite_start(std::span<const std::byte> bytes) {
  flush();
  const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), 0);
  if (written < 0) throw IoError(name(), "cannot be written again: " + reason(errno));
  if (static_cast<std::size_t>(written) != bytes.size())
    throw IoError(name(), "cannot be written: the disk took only a part");
}

void OutputFile::flush() {
  auto bytes = std::span<const std::byte>(buffer_).first(std::exchange(buffered_, 0));
  const std::size_t all = bytes.size();
  while (!bytes.empty()) {
    std::size_t count = bytes.size();
    if (give_up_ != nullptr && partial_.empty()) {
      wait_for_reader();
      count = std::min<std::size_t>(count, PIPE_BUF);  // so much does not block now
    }
    const ssize_t written = ::write(descriptor_, bytes.data(), count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw IoError(name(), "cannot be written: " + reason(errno));
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  whole_ += all;
}

std::filesystem::path OutputFile::keep_incomplete() noexcept {
  if (partial_.empty() || descriptor_ < 0) return {};
  try {
    std::filesystem::path kept = path_.string() + ".incomplete";
    (void)!::ftruncate(descriptor_, static_cast<off_t>(whole_));
    if (std::rename(partial_.c_str(), kept.c_str()) != 0) return {};
    partial_.clear();
    ::close(std::exchange(descriptor_, -1));
    return kept;
  } catch (const std::bad_alloc&) {
    return {};
  }
}

void OutputFile::wait_for_reader() const {
  constexpr int time_step_ms = 50;
  pollfd poll{descriptor_, POLLOUT, 0};
  while (::poll(&poll, 1, time_step_ms) <= 0) {
    if (give_up_()) throw IoError(name(), "cannot be written: nobody reads it");
  }
}

std::string OutputFile::name() const { return path_ == "-" ? "standard output" : path_.string(); }

void OutputFile::commit() {
  flush();
  if (!partial_.empty() && ::fsync(descriptor_) != 0)
    throw IoError(name(), "cannot be written to the disk: " + reason(errno));
  // Nobody takes it for abandoned before it has its name.
  const int lock = partial_.empty() ? -1 : ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
  // After a failed close nobody knows what reached the disk, so that is a failed write too.
  const int closed = ::close(std::exchange(descriptor_, -1));
  const int close_error = errno;
  if (partial_.empty()) {
    if (closed != 0) throw IoError(name(), "cannot be closed: " + reason(close_error));
    return;
  }
  const bool renamed = closed == 0 && std::rename(partial_.c_str(), path_.c_str()) == 0;
  const int error = closed != 0 ? close_error : errno;
  if (lock >= 0) ::close(lock);
  if (renamed) return;
  ::unlink(partial_.c_str());
  throw IoError(name(), "cannot be completed: " + reason(error));
}

}  // namespace seqloop::files
