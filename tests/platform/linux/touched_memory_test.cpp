// SPDX-License-Identifier: MIT
#include "seqloop/linux/touched_memory.hpp"

#include <gtest/gtest.h>

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

TEST(TouchedMemory, AsksForLargePages) {
  if (!std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled")) {
    GTEST_SKIP() << "this system has none";
  }
  const TouchedMemory memory(std::uint64_t{16} << 20U);
  const std::string flags = flags_of(memory.span().data());
  if (flags.empty()) GTEST_SKIP() << "this system does not tell";
  EXPECT_NE(flags.find(" hg "), std::string::npos) << flags;
}

TEST(TouchedMemory, ThatIsNotToBeHadIsRefused) {
  for (const std::uint64_t size :
       {std::numeric_limits<std::uint64_t>::max(), std::numeric_limits<std::uint64_t>::max() / 2}) {
    EXPECT_THROW(TouchedMemory{size}, SetupError);
  }
}

}  // namespace
}  // namespace seqloop::live
