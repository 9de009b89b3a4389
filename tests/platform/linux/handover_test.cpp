// SPDX-License-Identifier: MIT
// Two threads, one exchange: nothing torn, nothing twice, nothing out of order, nothing uncounted.
#include "seqloop/linux/detail/handover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <thread>

#include "seqloop/linux/detail/return_queue.hpp"

namespace seqloop::live {
namespace {

TEST(Handover, ThereIsNothingToTakeBeforeSomethingIsPublishedNorTwice) {
  Handover<int> handover;
  EXPECT_FALSE(handover.take());
  handover.writing() = 1;
  handover.publish();
  EXPECT_TRUE(handover.take());
  EXPECT_EQ(handover.reading(), 1);
  EXPECT_FALSE(handover.take());
  EXPECT_EQ(handover.reading(), 1) << "it stays until a newer one is taken";
}

TEST(Handover, TheNewestWinsAndTheWriterGetsTheOldBack) {
  Handover<int> handover;
  handover.writing() = 1;
  EXPECT_EQ(handover.publish(), 0) << "never used";
  handover.writing() = 2;
  EXPECT_EQ(handover.publish(), 1) << "never taken";
  EXPECT_TRUE(handover.take());
  EXPECT_EQ(handover.reading(), 2);
  handover.writing() = 3;
  handover.publish();
  EXPECT_TRUE(handover.take());
  EXPECT_EQ(handover.reading(), 3);
  handover.writing() = 4;
  EXPECT_EQ(handover.publish(), 2) << "the reader has finished with it";
  EXPECT_EQ(handover.reading(), 3) << "the reader's own slot is left alone";
}

struct Numbered {
  std::uint64_t number = 0;  // from 1
  std::array<std::uint64_t, 15> copies{};
  mutable bool taken = false;  // the reader's slot is its own: it may write into it
};

class HandoverOfTwoThreads : public testing::TestWithParam<std::uint32_t> {};

TEST_P(HandoverOfTwoThreads, KeepsOrderTearsNothingAndLosesNoCount) {
  constexpr std::uint64_t last = 100'000;
  const std::uint32_t seed = GetParam();
  SCOPED_TRACE(seed);
  Handover<Numbered> handover;
  std::uint64_t finished = 0;
  std::uint64_t dropped = 0;
  std::thread writer([&] {
    std::mt19937 random(seed);
    for (std::uint64_t number = 1; number <= last; ++number) {
      Numbered& value = handover.writing();
      value = {number, {}, false};
      value.copies.fill(number);
      const Numbered& before = handover.publish();
      if (before.number > 0) ++(before.taken ? finished : dropped);
      for (volatile std::uint32_t pause = random() % 64; pause > 0;) pause = pause - 1;
      if (random() % 256 == 0) std::this_thread::yield();
    }
  });
  std::mt19937 random(seed + 1);
  std::uint64_t newest = 0;
  std::uint64_t taken = 0;
  std::uint64_t skipped = 0;
  while (newest < last) {
    if (!handover.take()) continue;
    const Numbered& value = handover.reading();
    ASSERT_GT(value.number, newest);
    ASSERT_FALSE(value.taken);
    for (const std::uint64_t copy : value.copies) ASSERT_EQ(copy, value.number);
    value.taken = true;
    skipped += value.number - newest - 1;
    newest = value.number;
    ++taken;
    if (random() % 128 == 0) std::this_thread::yield();
  }
  writer.join();
  EXPECT_EQ(taken + skipped, last);
  EXPECT_EQ(skipped, dropped) << "the last one was taken, so every skipped one came back";
  EXPECT_EQ(finished + std::min<std::uint64_t>(taken, 2), taken)
      << "all came back but the one that is being read and the one before it";
}

INSTANTIATE_TEST_SUITE_P(Seeds, HandoverOfTwoThreads, testing::Values(1U, 2U, 3U, 4U));

TEST(ReturnQueue, GivesBackInOrderAndRefusesWhatItCannotHold) {
  ReturnQueue<int, 3> queue;
  EXPECT_EQ(queue.front(), nullptr);
  for (int round = 0; round < 5; ++round) {  // the ring wraps
    for (int value = 0; value < 3; ++value) EXPECT_TRUE(queue.push(10 * round + value));
    EXPECT_FALSE(queue.push(99));
    for (int value = 0; value < 3; ++value) {
      ASSERT_NE(queue.front(), nullptr);
      EXPECT_EQ(*queue.front(), 10 * round + value);
      queue.pop();
    }
    EXPECT_EQ(queue.front(), nullptr);
  }
}

TEST(ReturnQueue, BetweenTwoThreadsNothingIsLostOrTorn) {
  constexpr std::uint64_t count = 200'000;
  ReturnQueue<std::array<std::uint64_t, 8>, 4> queue;
  std::thread giver([&] {
    for (std::uint64_t next = 0; next < count;) {
      std::array<std::uint64_t, 8> value{};
      value.fill(next);
      if (queue.push(value)) ++next;
    }
  });
  for (std::uint64_t next = 0; next < count;) {
    const auto* value = queue.front();
    if (value == nullptr) continue;
    const auto right = static_cast<std::size_t>(std::count(value->begin(), value->end(), next));
    ASSERT_EQ(right, value->size()) << next;
    queue.pop();
    ++next;
  }
  giver.join();
}

}  // namespace
}  // namespace seqloop::live
