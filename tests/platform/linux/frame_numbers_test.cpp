// SPDX-License-Identifier: MIT
// Indices out of sequence numbers, and moments out of time stamps.
#include <gtest/gtest.h>

#include "seqloop/linux/detail/frame_numbers.hpp"
#include "seqloop/linux/detail/frame_stamps.hpp"

namespace seqloop::live {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

TEST(FrameNumbers, StartAtZeroWhateverTheDeviceSays) {
  FrameNumbers numbers;
  EXPECT_EQ(numbers.index_of(77), 0U);
  EXPECT_EQ(numbers.index_of(78), 1U);
  EXPECT_EQ(numbers.missed(), 0U);
}

TEST(FrameNumbers, CountWhatTheDeviceLost) {
  FrameNumbers numbers;
  (void)numbers.index_of(0);
  EXPECT_EQ(numbers.index_of(4), 4U);
  EXPECT_EQ(numbers.missed(), 3U);
}

TEST(FrameNumbers, GoOnAcrossTheWrap) {
  FrameNumbers numbers;
  (void)numbers.index_of(0xFFFFFFFE);
  EXPECT_EQ(numbers.index_of(0xFFFFFFFF), 1U);
  EXPECT_EQ(numbers.index_of(0), 2U);
  EXPECT_EQ(numbers.index_of(3), 5U);
  EXPECT_EQ(numbers.missed(), 2U);
}

TEST(FrameNumbers, FollowOnWhenTheStreamStartsAnew) {
  FrameNumbers numbers;
  (void)numbers.index_of(10);
  numbers.restart();
  EXPECT_EQ(numbers.index_of(500), 1U);
  EXPECT_EQ(numbers.index_of(501), 2U);
  EXPECT_EQ(numbers.index_of(0), 3U);  // a stream that started anew on its own
  EXPECT_EQ(numbers.index_of(1), 4U);
  EXPECT_EQ(numbers.missed(), 0U);
}

TEST(FrameNumbers, CountFramesOfADriverThatDoesNot) {
  FrameNumbers numbers;
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(numbers.index_of(0), i);
}

TEST(FrameStamps, PassGoodOnesOn) {
  FrameStamps stamps;
  for (int i = 0; i < 10; ++i) {
    const Nanoseconds arrived = 100s + i * 40ms;
    const auto judged = stamps.judge(arrived - 20ms, true, arrived);
    EXPECT_EQ(judged.stamp, arrived - 20ms);
    EXPECT_EQ(judged.odd, OddStamp::none);
  }
}

TEST(FrameStamps, AreNeverAfterTheArrival) {
  FrameStamps stamps;
  EXPECT_EQ(stamps.judge(100s + 3ms, true, 100s).stamp, 100s);
  EXPECT_EQ(stamps.count(OddStamp::in_the_future), 0U);  // clocks are read in turn
  EXPECT_EQ(stamps.judge(101s + 30ms, true, 101s).stamp, 101s);
  EXPECT_EQ(stamps.count(OddStamp::in_the_future), 1U);
}

TEST(FrameStamps, NameTheKindOfOddity) {
  FrameStamps stamps;
  EXPECT_EQ(stamps.judge(5s, false, 100s).odd, OddStamp::other_clock);
  EXPECT_EQ(stamps.judge(0s, true, 101s).odd, OddStamp::too_old);
  EXPECT_EQ(stamps.judge(102s - 10ms, true, 102s).odd, OddStamp::none);
  EXPECT_EQ(stamps.judge(102s - 10ms, true, 103s).odd, OddStamp::stood_still);
  EXPECT_EQ(stamps.judge(101s, true, 104s).odd, OddStamp::went_back);
  const auto after = stamps.judge(102s, true, 105s);
  EXPECT_EQ(after.odd, OddStamp::none);
  EXPECT_EQ(after.stamp, 105s);  // 104 s was told before
}

TEST(FrameStamps, TellAnOddityWhenItStartsAndCountItThen) {
  FrameStamps stamps;
  int told = 0;
  Nanoseconds arrived = 100s;
  const auto add = [&](Nanoseconds ahead) {
    arrived += 40ms;
    told += stamps.judge(arrived + ahead, true, arrived).tell ? 1 : 0;
  };
  for (int i = 0; i < 500; ++i) add(30ms);
  EXPECT_EQ(told, 1);
  for (int i = 0; i < 500; ++i) add(i % 2 == 0 ? 15ms : -10ms);
  EXPECT_EQ(told, 1);
  for (int i = 0; i < 400; ++i) add(-10ms);
  add(30ms);
  EXPECT_EQ(told, 2);
  EXPECT_EQ(stamps.count(OddStamp::in_the_future), 751U);
}

TEST(FrameStamps, NeverGoBack) {
  FrameStamps stamps;
  Nanoseconds last{0};
  std::uint64_t random = 12345;
  for (int i = 0; i < 20'000; ++i) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    const Nanoseconds arrived = 1000s + i * 10ms;
    const Nanoseconds off = std::chrono::milliseconds(static_cast<int>(random >> 44U) % 80'000);
    const auto judged = stamps.judge(arrived + 20ms - off, (random & 15U) != 0, arrived);
    ASSERT_GE(judged.stamp, last) << i;
    ASSERT_LE(judged.stamp, arrived) << i;
    last = judged.stamp;
  }
}

}  // namespace
}  // namespace seqloop::live
