// SPDX-License-Identifier: MIT
#include "seqloop/linux/system_calls.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <memory>

namespace seqloop::live {
namespace {

constexpr unsigned video_major = 81;  // of every V4L2 device, whatever it is called

/// Calls again for as long as a signal came in between.
template <class Call>
auto unbroken(Call call) noexcept {
  auto result = call();
  while (result == -1 && errno == EINTR) result = call();
  return result;
}

std::string group_name(gid_t group) {
  std::array<char, 4096> memory{};
  struct group entry {};
  struct group* found = nullptr;
  if (getgrgid_r(group, &entry, memory.data(), memory.size(), &found) == 0 && found != nullptr) {
    return found->gr_name;
  }
  return std::to_string(group);
}

class Kernel : public SystemCalls {
 public:
  Opened open(const char* path) noexcept override {
    const int fd = unbroken([&] { return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC); });
    return {fd, fd < 0 ? errno : 0};
  }

  // Linux lets go of the descriptor even when a signal came: never twice.
  int close(int fd) noexcept override { return ::close(fd) == 0 ? 0 : errno; }

  int ioctl(int fd, unsigned long request, void* argument) noexcept override {
    return unbroken([&] { return ::ioctl(fd, request, argument); }) == -1 ? errno : 0;
  }

  Mapped map(int fd, std::size_t length, std::int64_t offset) noexcept override {
    void* const address =
        ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, static_cast<off_t>(offset));
    if (address == MAP_FAILED) return {nullptr, errno};
    return {address, 0};
  }

  int unmap(void* address, std::size_t length) noexcept override {
    return ::munmap(address, length) == 0 ? 0 : errno;
  }

  // A signal ends the wait: it may be what asks the caller to stop.
  Polled poll(int fd, short events, int milliseconds) noexcept override {
    pollfd watched{fd, events, 0};
    const int ready = ::poll(&watched, 1, milliseconds);
    if (ready < 0) return {0, errno == EINTR ? 0 : errno};
    return {ready == 0 ? short{0} : watched.revents, 0};
  }

  std::vector<std::string> list_folder(const std::string& path) override {
    std::vector<std::string> names;
    const auto shut = [](DIR* folder) { ::closedir(folder); };
    const std::unique_ptr<DIR, decltype(shut)> folder(::opendir(path.c_str()), shut);
    if (!folder) return names;
    // Only this thread reads this folder's stream.
    while (const dirent* entry = ::readdir(folder.get())) {  // NOLINT(concurrency-mt-unsafe)
      names.emplace_back(entry->d_name);
    }
    return names;
  }

  std::string read_text(const std::string& path) override {
    const int fd =
        unbroken([&] { return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC); });
    if (fd < 0) return {};
    std::array<char, 256> text{};
    const ssize_t size = unbroken([&] { return ::read(fd, text.data(), text.size()); });
    ::close(fd);
    std::string result(text.data(), size < 0 ? 0 : static_cast<std::size_t>(size));
    result.erase(result.find_last_not_of(" \t\r\n") + 1);
    return result;
  }

  std::string resolve(const std::string& path) override {
    std::array<char, PATH_MAX> text{};
    return ::realpath(path.c_str(), text.data()) == nullptr ? std::string() : text.data();
  }

  FileFacts facts(const std::string& path) override {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return {FileKind::missing, errno, {}};
    FileKind kind = FileKind::file;
    if (S_ISDIR(status.st_mode)) {
      kind = FileKind::folder;
    } else if (S_ISCHR(status.st_mode) && major(status.st_rdev) == video_major) {
      kind = FileKind::video_device;
    } else if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) {
      kind = FileKind::other_device;
    }
    return {kind, 0, group_name(status.st_gid)};
  }
};

}  // namespace

SystemCalls& system_calls() noexcept {
  static Kernel kernel;
  return kernel;
}

}  // namespace seqloop::live
