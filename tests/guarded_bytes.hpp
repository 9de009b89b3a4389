// SPDX-License-Identifier: MIT
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

namespace seqloop::test {

/// Bytes behind which no memory may be read: one byte too far ends the program, whoever reads it.
class GuardedBytes {
 public:
  /// @param most bytes that may be held
  explicit GuardedBytes(std::size_t most) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    size_ = (most + page - 1) / page * page;
    memory_ =
        mmap(nullptr, size_ + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
    guard_ = static_cast<std::uint8_t*>(memory_) + size_;
    if (mprotect(guard_, page, PROT_NONE) != 0) throw std::bad_alloc();
    size_ += page;
  }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;
  GuardedBytes(GuardedBytes&&) = delete;
  GuardedBytes& operator=(GuardedBytes&&) = delete;
  ~GuardedBytes() { munmap(memory_, size_); }

  /// @return a copy that ends where the memory ends; valid until the next call
  std::span<const std::uint8_t> hold(std::span<const std::uint8_t> bytes) {
    std::uint8_t* start = guard_ - bytes.size();
    std::copy(bytes.begin(), bytes.end(), start);
    return {start, bytes.size()};
  }

 private:
  std::size_t size_ = 0;
  void* memory_ = nullptr;
  std::uint8_t* guard_ = nullptr;
};

}  // namespace seqloop::test
