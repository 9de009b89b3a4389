// SPDX-License-Identifier: MIT
// What is learnt of the frames of accepted answers, and how little of it is asked of others.
#include "seqloop/detail/accepted_frames.hpp"

#include <gtest/gtest.h>

namespace seqloop {
namespace {

TEST(AcceptedFrames, AsksForAllThatIsUsualBeforeAnyWasTaken) {
  AcceptedFrames accepted;
  EXPECT_EQ(accepted.least_gain(0.5), 0.5);
  EXPECT_EQ(accepted.least_margin(0.04), 0.04);
  accepted.take(0.0, 0.0, -0.2);
  EXPECT_EQ(accepted.least_gain(0.5), 0.5) << "a frame without novelty says nothing";
}

TEST(AcceptedFrames, AsksForAPartOfWhatTheyGainByNovelty) {
  AcceptedFrames accepted;
  // The mean is of novel frames: of the first half of one, and of a whole one.
  accepted.take(0.5 * 0.2, 0.5, 0.02);
  accepted.take(1.0 * 0.8, 1.0, 0.08);
  EXPECT_NEAR(accepted.least_gain(0.5), 0.4 * (0.5 * 0.2 + 0.8) / 1.5, 1e-12);
  EXPECT_NEAR(accepted.least_margin(0.04), 0.4 * (0.5 * 0.02 + 0.08) / 1.5, 1e-12);
}

TEST(AcceptedFrames, AsksForNoMoreThanIsUsualAndForNoLoss) {
  AcceptedFrames accepted;
  accepted.take(3.0, 1.0, -0.1);
  EXPECT_EQ(accepted.least_gain(0.5), 0.5);
  EXPECT_EQ(accepted.least_margin(0.04), 0.0);
  EXPECT_EQ(accepted.least_gain(0.0), 0.0) << "where wrong rows lose, nothing is usual";
}

TEST(AcceptedFrames, ForgetsWhatIsLongPast) {
  AcceptedFrames accepted;
  for (int frame = 0; frame < 500; ++frame) accepted.take(1.0, 0.5, 0.1);
  for (int frame = 0; frame < 500; ++frame) accepted.take(0.1, 0.5, 0.01);
  EXPECT_NEAR(accepted.least_gain(1.0), 0.4 * 0.2, 0.01);
  EXPECT_NEAR(accepted.least_margin(1.0), 0.4 * 0.01, 0.001);
}

}  // namespace
}  // namespace seqloop
