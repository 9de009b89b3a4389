// SPDX-License-Identifier: MIT
#include "core/allocation_guard.hpp"

#include <cerrno>
#include <cstdlib>

namespace {

// Not a C++ thread_local object: those may allocate on first use.
__thread std::size_t allocations = 0;

}  // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// The C library's own entry points, which it keeps reachable for exactly this.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  ++allocations;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}

bool seqloop::AllocationGuard::works() noexcept { return true; }

#else

bool seqloop::AllocationGuard::works() noexcept { return false; }

#endif

seqloop::AllocationGuard::AllocationGuard() noexcept : before_(allocations) {}

std::size_t seqloop::AllocationGuard::count() const noexcept { return allocations - before_; }
