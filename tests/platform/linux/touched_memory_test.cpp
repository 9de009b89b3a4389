// SPDX-License-Identifier: MIT
#include "seqloop/linux/touched_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
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

TEST(TouchedMemory, ThatIsNotToBeHadIsRefused) {
  for (const std::uint64_t size :
       {std::numeric_limits<std::uint64_t>::max(), std::numeric_limits<std::uint64_t>::max() / 2}) {
    EXPECT_THROW(TouchedMemory{size}, SetupError);
  }
}

}  // namespace
}  // namespace seqloop::live
