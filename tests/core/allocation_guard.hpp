// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace seqloop {

/// Counts this thread's calls of malloc, calloc, realloc, aligned_alloc, posix_memalign and so of
/// operator new. Works only in a program that links allocation_guard.cpp.
class AllocationGuard {
 public:
  AllocationGuard() noexcept;
  /// Allocations since this guard was made.
  [[nodiscard]] std::size_t count() const noexcept;
  /// Sanitizers bring a heap of their own, which cannot be counted.
  [[nodiscard]] static bool works() noexcept;

 private:
  std::size_t before_;
};

}  // namespace seqloop
