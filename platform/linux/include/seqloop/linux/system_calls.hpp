// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace seqloop::live {

/// What a path leads to.
enum class FileKind : std::uint8_t { missing, video_device, other_device, folder, file };

struct FileFacts {
  FileKind kind = FileKind::missing;
  int error = 0;      ///< of `missing`: errno
  std::string group;  ///< that owns it: its name, or its number where it has none
};

/// Port: exactly the calls of the operating system that a camera needs, so that tests can stand in
/// for the kernel. Errors are returned as errno, 0 being none. What returns strings allocates and
/// may throw std::bad_alloc; nothing else does either.
class SystemCalls {
 public:
  struct Opened {
    int fd = -1;
    int error = 0;
  };
  struct Mapped {
    void* address = nullptr;
    int error = 0;
  };
  struct Polled {
    short events = 0;  ///< 0: the time is over, or a signal came
    int error = 0;
  };

  SystemCalls() = default;
  SystemCalls(const SystemCalls&) = delete;
  SystemCalls& operator=(const SystemCalls&) = delete;
  SystemCalls(SystemCalls&&) = delete;
  SystemCalls& operator=(SystemCalls&&) = delete;
  virtual ~SystemCalls() = default;

  /// For reading and writing; calls on it do not block, and child processes do not get it.
  [[nodiscard]] virtual Opened open(const char* path) noexcept = 0;
  virtual int close(int fd) noexcept = 0;
  [[nodiscard]] virtual int ioctl(int fd, unsigned long request, void* argument) noexcept = 0;
  /// Shared, for reading and writing.
  [[nodiscard]] virtual Mapped map(int fd, std::size_t length, std::int64_t offset) noexcept = 0;
  virtual int unmap(void* address, std::size_t length) noexcept = 0;
  [[nodiscard]] virtual Polled poll(int fd, short events, int milliseconds) noexcept = 0;

  /// Names in a folder, unsorted; none where it cannot be read.
  [[nodiscard]] virtual std::vector<std::string> list_folder(const std::string& path) = 0;
  /// The start of a small file, without white space at its end; empty where it cannot be read.
  [[nodiscard]] virtual std::string read_text(const std::string& path) = 0;
  /// The path without any symbolic link in it; empty where it leads nowhere.
  [[nodiscard]] virtual std::string resolve(const std::string& path) = 0;
  [[nodiscard]] virtual FileFacts facts(const std::string& path) = 0;
};

/// The kernel that runs this program. Has no state: any thread may call it.
[[nodiscard]] SystemCalls& system_calls() noexcept;

}  // namespace seqloop::live
