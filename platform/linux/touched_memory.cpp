// SPDX-License-Identifier: MIT
#include "seqloop/linux/touched_memory.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <string>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::live {
namespace {

// What a thread touches at least: some milliseconds' worth.
constexpr std::size_t least_share = std::size_t{16} << 20U;

// What is asked for by one call: while it lasts, nobody in the process can map memory or begin a
// thread, and who touches next waits behind those that want to.
constexpr std::size_t piece_bytes = std::size_t{1} << 20U;

/// Linux has this from 5.14 on; before, pages come when they are first written to.
void touch(std::span<std::byte> memory) noexcept {
#ifdef MADV_POPULATE_WRITE
  while (!memory.empty()) {
    const std::span<std::byte> piece = memory.first(std::min(piece_bytes, memory.size()));
    ::madvise(piece.data(), piece.size(), MADV_POPULATE_WRITE);
    memory = memory.subspan(piece.size());
  }
#else
  static_cast<void>(memory);
#endif
}

}  // namespace

TouchedMemory::TouchedMemory(std::uint64_t bytes) {
  const auto size = static_cast<std::size_t>(bytes);
  void* const taken = size == bytes ? ::mmap(nullptr, size, PROT_READ | PROT_WRITE,
                                             MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                                    : MAP_FAILED;
  if (taken == MAP_FAILED) {
    throw SetupError({"memory", std::to_string(bytes) + " bytes are not to be had",
                      "lower the capacity; `plan` shows what each buffer takes"});
  }
  span_ = {static_cast<std::byte*>(taken), size};
#ifdef MADV_HUGEPAGE
  // Where the system has large pages, reading all rows waits less for their addresses: a matrix of
  // floats takes 6 % less time. Where it has none, nothing is lost.
  ::madvise(taken, size, MADV_HUGEPAGE);
#endif
  // Shares are whole numbers of pages, up to the last one's end.
  const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t share = (size / processors / least_share + 1) * least_share;
  for (std::size_t first = 0; first < size; first += share) {
    touching_.emplace_back(touch, span_.subspan(first, std::min(share, size - first)));
  }
}

TouchedMemory::TouchedMemory(TouchedMemory&& other) noexcept
    : span_(std::exchange(other.span_, {})), touching_(std::move(other.touching_)) {}

TouchedMemory::~TouchedMemory() {
  wait();
  if (!span_.empty()) ::munmap(span_.data(), span_.size());
}

}  // namespace seqloop::live
