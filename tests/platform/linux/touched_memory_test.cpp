// SPDX-License-Identifier: MIT
#include "seqloop/linux/touched_memory.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "seqloop/detail/arena.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::live {
namespace {

TEST(TouchedMemory, IsZeroOfAnySizeAndMayBeWritten) {
  constexpr std::uint64_t share = std::uint64_t{16} << 20U;
  for (const std::uint64_t size :
       {std::uint64_t{1}, std::uint64_t{4096}, share - 1, share, share + 1, 5 * share / 2}) {
    const TouchedMemory memory(size);
    const std::span<std::byte> bytes = memory.span();
    ASSERT_EQ(bytes.size(), size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(bytes.data()) % Arena::alignment, 0U);
    EXPECT_TRUE(std::ranges::all_of(bytes, [](std::byte byte) { return byte == std::byte{0}; }));
    std::ranges::fill(bytes, std::byte{7});
    EXPECT_EQ(std::ranges::count(bytes, std::byte{7}), static_cast<std::ptrdiff_t>(size));
  }
}

TEST(TouchedMemory, MovesWithItsOwner) {
  TouchedMemory first(100);
  first.span()[99] = std::byte{3};
  const TouchedMemory second(std::move(first));
  EXPECT_EQ(second.span()[99], std::byte{3});
}

/// The flags that the system has of the mapping with a byte, or nothing.
std::string flags_of(const void* byte) {
  const auto address = reinterpret_cast<std::uintptr_t>(byte);
  std::ifstream mappings("/proc/self/smaps");
  bool there = false;
  for (std::string line; std::getline(mappings, line);) {
    std::istringstream words(line);
    std::uintptr_t first = 0;
    std::uintptr_t last = 0;
    char to = 0;
    if (words >> std::hex >> first >> to >> last && to == '-') {
      there = first <= address && address < last;
    } else if (there && line.rfind("VmFlags:", 0) == 0) {
      return line + ' ';
    }
  }
  return {};
}

/// Whether large pages are asked for, as the system has it.
bool asks_for_large_pages(const void* byte) {
  return flags_of(byte).find(" hg ") != std::string::npos;
}

TEST(TouchedMemory, AsksForLargePages) {
  // Some systems have no large pages; what emulates a processor may take no advice.
  constexpr std::size_t size = std::size_t{16} << 20U;
  void* const advised =
      mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(advised, MAP_FAILED);
  const bool told = madvise(advised, size, MADV_HUGEPAGE) == 0 && asks_for_large_pages(advised);
  munmap(advised, size);
  if (!told) GTEST_SKIP() << "this system does not tell";
  const TouchedMemory memory(size);
  EXPECT_TRUE(asks_for_large_pages(memory.span().data())) << flags_of(memory.span().data());
}

TEST(TouchedMemory, ThatIsNotToBeHadIsRefused) {
  for (const std::uint64_t size :
       {std::numeric_limits<std::uint64_t>::max(), std::numeric_limits<std::uint64_t>::max() / 2}) {
    EXPECT_THROW(TouchedMemory{size}, SetupError);
  }
}

}  // namespace
}  // namespace seqloop::live
