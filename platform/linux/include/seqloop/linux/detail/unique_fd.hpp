// SPDX-License-Identifier: MIT
#pragma once

#include <utility>

#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// A file descriptor with one owner, who closes it.
class UniqueFd {
 public:
  UniqueFd(SystemCalls& system, int fd) noexcept : system_(&system), fd_(fd) {}
  UniqueFd(const UniqueFd&) = delete;
  UniqueFd& operator=(const UniqueFd&) = delete;
  UniqueFd(UniqueFd&& other) noexcept : system_(other.system_), fd_(std::exchange(other.fd_, -1)) {}
  UniqueFd& operator=(UniqueFd&& other) noexcept {
    if (this != &other) {
      reset();
      system_ = other.system_;
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }
  ~UniqueFd() { reset(); }

  /// -1 once it is closed or moved away.
  [[nodiscard]] int get() const noexcept { return fd_; }

  void reset() noexcept {
    if (fd_ >= 0) system_->close(std::exchange(fd_, -1));
  }

 private:
  SystemCalls* system_;
  int fd_;
};

}  // namespace seqloop::live
