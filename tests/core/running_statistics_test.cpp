// SPDX-License-Identifier: MIT
// Running statistics beside the batch definition.
#include "seqloop/detail/running_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "core/matcher.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

Standardisation within(std::size_t horizon) {
  Standardisation how;
  how.horizon = horizon;
  return how;
}

TEST(RunningStatistics, EqualTheBatchDefinition) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 3);
  std::mt19937 random(5);
  std::normal_distribution<float> normal(2.0F, 3.0F);
  std::vector<std::vector<float>> frames;
  for (int i = 0; i < 200; ++i) {
    frames.push_back({normal(random), normal(random), 7.0F});
    statistics.observe(frames.back());
  }
  for (std::size_t d = 0; d < 3; ++d) {
    double mean = 0.0;
    double variance = 0.0;
    for (const auto& frame : frames) mean += static_cast<double>(frame[d]) / 200.0;
    for (const auto& frame : frames)
      variance += std::pow(static_cast<double>(frame[d]) - mean, 2.0) / 200.0;
    EXPECT_NEAR(statistics.mean()[d], mean, 1e-9);
    EXPECT_NEAR(statistics.variance()[d], variance, 1e-9);
  }
  std::vector<float> out(3);
  EXPECT_TRUE(statistics.standardise(frames[0], out));
  EXPECT_EQ(out[2], 0.0F) << "a feature that never changes says nothing";
  EXPECT_NEAR(std::hypot(out[0], out[1]), 1.0, 1e-6);
}

TEST(RunningStatistics, StandardiseEqualsTheDefinitionForEverySize) {
  std::mt19937 random(6);
  std::normal_distribution<float> normal;
  for (const std::size_t size : {1U, 7U, 8U, 9U, 735U}) {
    TestArena memory;
    RunningStatistics statistics(memory.arena, size);
    std::vector<float> frame(size);
    for (int i = 0; i < 20; ++i) {
      // Features of very different deviations, some below either floor.
      for (std::size_t d = 0; d < size; ++d) {
        const float usual = 3.0F - 3.0F * static_cast<float>(d % 3);
        frame[d] = usual + normal(random) / static_cast<float>(d + 1);
      }
      statistics.observe(frame);
    }
    double deviations = 0.0;
    for (const double variance : statistics.variance()) deviations += std::sqrt(variance);
    std::vector<double> right(size);
    double squares = 0.0;
    for (std::size_t d = 0; d < size; ++d) {
      const double mean = statistics.mean()[d];
      right[d] = (static_cast<double>(frame[d]) - mean) /
                 std::max({std::sqrt(statistics.variance()[d]),
                           0.1 * deviations / static_cast<double>(size), std::abs(mean) / 8.0});
      squares += right[d] * right[d];
    }
    std::vector<float> out(size);
    EXPECT_TRUE(statistics.standardise(frame, out));
    for (std::size_t d = 0; d < size; ++d) {
      const double value = right[d] / std::sqrt(squares);
      EXPECT_NEAR(static_cast<double>(out[d]), value, 3e-7 * std::abs(value)) << size << ' ' << d;
    }
  }
}

// Three tenths of the picture show the robot itself. How large that is beside the rest, in a vector
// of unit length, is all that changes of it.
TEST(RunningStatistics, WhatAllFramesShowAlikeCountsForLittle) {
  constexpr std::size_t size = 100;
  constexpr std::size_t seen = 70;
  std::mt19937 random(8);
  std::normal_distribution<float> normal;
  TestArena memory;
  RunningStatistics statistics(memory.arena, size);
  std::vector<float> frame(size);
  std::vector<float> out(size);
  double share = 0.0;
  for (int i = 0; i < 400; ++i) {
    const float texture = std::exp(0.05F * normal(random));
    for (std::size_t d = 0; d < size; ++d) {
      frame[d] = d < seen ? texture * std::abs(normal(random)) : 1.0F;
    }
    ASSERT_TRUE(normalise(frame));
    statistics.observe(frame);
    if (i < 300) continue;
    ASSERT_TRUE(statistics.standardise(frame, out));
    for (std::size_t d = seen; d < size; ++d) share += static_cast<double>(out[d] * out[d]) / 100.0;
  }
  std::printf("%.3f of what is left\n", share);
  EXPECT_LT(share, 0.15);
}

TEST(RunningStatistics, FirstFrameBecomesTheZeroVector) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 2);
  const std::vector<float> frame{1.0F, 2.0F};
  statistics.observe(frame);
  std::vector<float> out{9.0F, 9.0F};
  EXPECT_FALSE(statistics.standardise(frame, out));
  EXPECT_EQ(out, (std::vector<float>{0.0F, 0.0F}));
}

TEST(RunningStatistics, StartFromAnotherDriveAndMoveOn) {
  TestArena memory;
  RunningStatistics map(memory.arena, 1);
  for (const float value : {1.0F, 3.0F, 1.0F, 3.0F}) map.observe(std::vector<float>{value});
  RunningStatistics query(memory.arena, 1);
  query.start_from(map, 2);
  EXPECT_EQ(query.frames(), 2U);
  EXPECT_EQ(query.mean()[0], 2.0);
  query.follow(std::vector<float>{5.0F}, within(100));
  EXPECT_DOUBLE_EQ(query.mean()[0], 3.0) << "one frame against a prior of two";
  EXPECT_DOUBLE_EQ(query.variance()[0], (2.0 / 3.0) * (1.0 + 9.0 / 3.0));
  query.start_from(map, 99);
  EXPECT_EQ(query.frames(), 4U) << "a prior counts for no more than what was seen";
}

TEST(RunningStatistics, ForgetBeyondTheHorizon) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 1);
  for (int i = 0; i < 1000; ++i) {
    statistics.follow(std::vector<float>{i % 2 == 0 ? -1.0F : 1.0F}, within(10));
  }
  for (int i = 0; i < 100; ++i) {
    statistics.follow(std::vector<float>{i % 2 == 0 ? 8.0F : 12.0F}, within(10));
  }
  EXPECT_NEAR(statistics.mean()[0], 10.0, 0.2);
}

TEST(RunningStatistics, AHaltTeachesThemNothing) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 2);
  for (int i = 0; i < 50; ++i) {
    statistics.follow(std::vector<float>{i % 2 == 0 ? -1.0F : 1.0F, i % 3 == 0 ? 2.0F : -1.0F},
                      within(20));
  }
  statistics.follow(std::vector<float>{1.5F, 1.5F}, within(20));
  const double before = statistics.mean()[0];
  for (int i = 0; i < 500; ++i) statistics.follow(std::vector<float>{1.5F, 1.51F}, within(20));
  EXPECT_EQ(statistics.mean()[0], before);
}

TEST(RunningStatistics, AreGuessedFromAFirstFrame) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 4);
  Standardisation how;
  how.prior_frames = 19;
  statistics.follow(std::vector<float>{1.0F, 1.0F, 3.0F, 3.0F}, how);
  EXPECT_EQ(statistics.frames(), 20U);
  for (std::size_t d = 0; d < 4; ++d) {
    const double off = d < 2 ? -1.0 : 1.0;
    EXPECT_NEAR(statistics.mean()[d], 2.0 + .75 * off, 1e-12) << "beside one guess";
    EXPECT_NEAR(statistics.variance()[d], 0.95 * (0.25 + 0.25 / 20.0), 1e-12) << "beside 19";
  }
  std::vector<float> out(4);
  EXPECT_TRUE(statistics.standardise(std::vector<float>{1.0F, 1.0F, 3.0F, 3.0F}, out));
}

// A lens that is covered as the camera is switched on, say.
TEST(RunningStatistics, SoonForgetAFirstFrameUnlikeAllOthers) {
  std::mt19937 random(13);
  std::normal_distribution<float> normal(0.0F, 0.1F);
  TestArena memory;
  RunningStatistics statistics(memory.arena, 2);
  statistics.follow(std::vector<float>{-8.0F, 3.0F}, {});
  for (int i = 0; i < 40; ++i) {
    statistics.follow(std::vector<float>{5.0F + normal(random), 1.0F + 20.0F * normal(random)}, {});
  }
  EXPECT_GT(statistics.frames(), Standardisation{}.prior_frames + 10U);
  EXPECT_NEAR(statistics.mean()[0], 5.0, 1.5);
}

// As those of many networks: a profile, and a little of their own. A robot that stands shows noise.
TEST(RunningStatistics, LearnFromFramesThatHaveMuchInCommonAndNotFromNoise) {
  const auto taken = [](double own, int frames) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    TestArena memory;
    RunningStatistics statistics(memory.arena, 64);
    std::vector<float> frame(64);
    for (int i = 0; i < frames; ++i) {
      for (std::size_t d = 0; d < frame.size(); ++d) {
        frame[d] = static_cast<float>(static_cast<double>(d % 8) + own * normal(random));
      }
      statistics.follow(frame, {});
    }
    return statistics.frames() - Standardisation{}.prior_frames;
  };
  EXPECT_EQ(taken(2.0, 60), 60U);
  EXPECT_EQ(taken(.5, 60), 60U) << "a twenty-first of what the profile varies by";
  EXPECT_EQ(taken(.2, 300), 1U);
}

}  // namespace
}  // namespace seqloop
