// SPDX-License-Identifier: MIT
#include "bags/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "seqloop/fault.hpp"

namespace seqloop::bags {
namespace {

/// Read, not mapped: a file that becomes shorter is then an error and no sudden death.
class FileBytes : public ByteSource {
 public:
  explicit FileBytes(const std::filesystem::path& file)
      : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status {};
    const bool open = descriptor_ >= 0 && ::fstat(descriptor_, &status) == 0;
    const int error = errno;
    if (open && S_ISREG(status.st_mode)) {
      size_ = static_cast<std::uint64_t>(status.st_size);
      return;
    }
    if (descriptor_ >= 0) ::close(descriptor_);
    if (open) throw SetupError(Fault{file.string(), "is not a file"});
    throw SetupError(Fault{file.string(), std::strerror(error), "check the name"});
  }
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  FileBytes(FileBytes&&) = delete;
  FileBytes& operator=(FileBytes&&) = delete;
  ~FileBytes() override { ::close(descriptor_); }

  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }

  [[nodiscard]] bool read(std::uint64_t place, std::span<std::uint8_t> into) noexcept override {
    if (place > size_ || into.size() > size_ - place) return false;
    while (!into.empty()) {
      const ssize_t count =
          ::pread(descriptor_, into.data(), into.size(), static_cast<off_t>(place));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      place += static_cast<std::uint64_t>(count);
      into = into.subspan(static_cast<std::size_t>(count));
    }
    return true;
  }

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace

std::unique_ptr<ByteSource> open_file(const std::filesystem::path& file) {
  return std::make_unique<FileBytes>(file);
}

}  // namespace seqloop::bags
