// SPDX-License-Identifier: MIT
// What is learnt of the frames of accepted answers, and how little of it is asked of others.
#include "seqloop/detail/accepted_frames.hpp"

#include <gtest/gtest.h>

namespace seqloop {
namespace {

constexpr AcceptedFrames::Asked usual{0.5, 0.04};

void expect_asked(const AcceptedFrames& accepted, AcceptedFrames::Asked expected) {
  const AcceptedFrames::Asked asked = accepted.asked(usual);
  EXPECT_NEAR(asked.gain, expected.gain, 1e-12);
  EXPECT_NEAR(asked.margin, expected.margin, 1e-12);
}

TEST(AcceptedFrames, AsksForAllThatIsUsualBeforeAnyWasTaken) {
  AcceptedFrames accepted;
  expect_asked(accepted, usual);
  accepted.take(0.0, 0.0, -0.2);
  SCOPED_TRACE("a frame without novelty says nothing");
  expect_asked(accepted, usual);
}

TEST(AcceptedFrames, AsksForAPartOfWhatTheyHaveByNovelty) {
  AcceptedFrames accepted;
  // The means are of novel frames: of the first half of one, and of a whole one.
  accepted.take(0.5 * 0.2, 0.5, 0.02);
  accepted.take(1.0 * 0.8, 1.0, 0.08);
  expect_asked(accepted, {0.4 * (0.5 * 0.2 + 0.8) / 1.5, 0.4 * (0.5 * 0.02 + 0.08) / 1.5});
}

TEST(AcceptedFrames, AsksForAllWhereTheyGainEnoughWhateverTheirMargin) {
  AcceptedFrames accepted;
  accepted.take(0.5 / 0.4, 1.0, -0.1);
  expect_asked(accepted, usual);
  EXPECT_EQ(accepted.asked({0.0, 0.04}).margin, 0.04) << "where wrong rows lose, nothing is usual";
}

TEST(AcceptedFrames, AsksForNoLossAndForNoMoreThanIsUsual) {
  AcceptedFrames lose;
  lose.take(-1.0, 1.0, -0.1);
  expect_asked(lose, {0.0, 0.0});
  AcceptedFrames stand_out;
  stand_out.take(0.1, 1.0, 0.2);
  expect_asked(stand_out, {0.04, 0.04});
}

TEST(AcceptedFrames, ForgetsWhatIsLongPast) {
  AcceptedFrames accepted;
  for (int frame = 0; frame < 500; ++frame) accepted.take(1.0, 0.5, 0.1);
  for (int frame = 0; frame < 500; ++frame) accepted.take(0.1, 0.5, 0.01);
  EXPECT_NEAR(accepted.asked(usual).gain, 0.4 * 0.2, 0.01);
  EXPECT_NEAR(accepted.asked(usual).margin, 0.4 * 0.01, 0.001);
}

}  // namespace
}  // namespace seqloop
