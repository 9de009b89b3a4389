// SPDX-License-Identifier: MIT
// What `plan` says against what the process really takes.
#include <algorithm>
#include <deque>

#include "core/matcher.hpp"
#include "expect_setup_error.hpp"
#include "resident_memory.hpp"

namespace seqloop {
namespace {

double resident_bytes() { return static_cast<double>(test::resident_bytes()); }

TEST(Memory, ThePlanIsWhatTheProcessGrowsBy) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's shadow memory counts as resident";
#endif
  const Capacity capacity{20'000, 735};
  const oracle::Vectors drive = oracle::drive(1, 300, 735);
  // What was freed would stay resident and be taken again unseen.
  std::deque<PlaceMap> maps;
  std::deque<Detector> detectors;
  for (const Arithmetic arithmetic : {Arithmetic::int8, Arithmetic::sketch, Arithmetic::float32}) {
    for (const bool relocalising : {true, false}) {
      SCOPED_TRACE("arithmetic " + std::to_string(static_cast<int>(arithmetic)) +
                   (relocalising ? ", relocalising" : ""));
      MatcherConfig config;
      config.arithmetic = arithmetic;
      config.relocalising.on = relocalising;
      config.full_map = FullMap::thin;
      config.sequence_length = 100;
      config.use = Use::close_loops;
      const double planned = static_cast<double>(PlaceMap::bytes_needed(config, capacity) +
                                                 Detector::bytes_needed(config, capacity));
      const double before = resident_bytes();
      PlaceMap& map = maps.emplace_back(config, capacity);
      Detector& detector = detectors.emplace_back(config, map);
      const double built = resident_bytes() - before;
      for (const auto& descriptor : drive) (void)detector.step(descriptor);
      const double stepped = resident_bytes() - before;

      std::printf("planned %.0f bytes, grown by %.0f when built and %.0f after 300 steps\n",
                  planned, built, stepped);
      constexpr double slack = 1048576.0;
      EXPECT_NEAR(stepped, planned, 0.05 * planned);
      EXPECT_NEAR(stepped, built, slack) << "every page is there before the first step";
    }
  }
}

TEST(Memory, ThatIsKnownToBeZeroIsNotWrittenTo) {
  const ArenaMemory memory(64, {});
  std::ranges::fill(memory.span(), std::byte{7});
  Arena as_it_is(memory.span(), true);
  EXPECT_EQ(as_it_is.take<std::uint8_t>("bytes", 64).back(), 7);
  Arena zeroed(memory.span());
  EXPECT_EQ(zeroed.take<std::uint8_t>("bytes", 64).back(), 0);
}

TEST(Memory, WhatIsGivenHasAllItsFaultsNamedAtOnce) {
  const ArenaMemory memory(64, {});
  const std::string message =
      test::setup_error([&] { const ArenaMemory given(64, memory.span().subspan(1)); });
  EXPECT_TRUE(test::says(message, "63 bytes given, 64 needed; ask bytes_needed()"));
  EXPECT_TRUE(test::says(message, "not aligned to 64 bytes; "));
}

TEST(Memory, MoreThanA32BitSystemAddressesIsPlannedToTheByteAndRefused) {
  const MatcherConfig config;
  const Capacity capacity{100'000'000, 65'536};
  const std::uint64_t planned = PlaceMap::bytes_needed(config, capacity);
  EXPECT_GT(planned, std::uint64_t{capacity.places} * capacity.descriptor_size);
  EXPECT_LT(planned, std::uint64_t{capacity.places} * capacity.descriptor_size / 100 * 102);
  const ArenaMemory given(64, {});
  const std::string message = test::setup_error([&] { PlaceMap(config, capacity, given.span()); });
  EXPECT_TRUE(test::says(message, std::to_string(planned) + " needed"));
  if constexpr (sizeof(std::size_t) == 4) {
    const std::string alone = test::setup_error([&] { PlaceMap(config, capacity); });
    EXPECT_TRUE(test::says(alone, std::to_string(planned) + " bytes are not to be had"));
  }
}

}  // namespace
}  // namespace seqloop
