// SPDX-License-Identifier: MIT
#include "seqloop/detail/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace seqloop {
namespace {

double log_odds(double probability) { return std::log(probability / (1.0 - probability)); }
double of_odds(double odds) { return 1.0 / (1.0 + std::exp(-odds)); }

TEST(Calibration, RisesFromZeroToOneAndCanBeTurnedRound) {
  double before = 0.0;
  for (int i = 1; i < 1000; ++i) {
    const double probability = of_odds(-20.0 + 0.04 * i);
    const double right = calibrated(probability);
    ASSERT_GT(right, before) << probability;
    ASSERT_LT(right, 1.0) << probability;
    ASSERT_NEAR(log_odds(before_calibration(right)), log_odds(probability), 1e-4) << probability;
    before = right;
  }
}

TEST(Calibration, SaysWhatWasRight) {
  // Section 6.6, below it, and between.
  for (const auto& [given, right] : {std::pair{-14.0, -4.3 - 0.2},
                                     {-13.0, -4.3},
                                     {-9.0, -3.3},
                                     {-4.6, -2.1},
                                     {-1.4, -1.5},
                                     {-0.3, -1.25},
                                     {0.8, 0.0},
                                     {1.5, 0.45},
                                     {2.2, 0.9},
                                     {2.92, 1.6},
                                     {2.944, 2.944}}) {
    EXPECT_NEAR(log_odds(calibrated(of_odds(given))), right, 1e-9) << given;
  }
}

TEST(Calibration, LeavesWhatIsAccepted) {
  for (const double probability : {0.95, 0.99, 0.999999, 1.0}) {
    EXPECT_EQ(calibrated(probability), probability);
    EXPECT_EQ(before_calibration(probability), probability);
  }
}

TEST(Calibration, TakesTheEnds) {
  EXPECT_GE(calibrated(0.0), 0.0);
  EXPECT_LT(calibrated(0.0), 0.001);
  EXPECT_EQ(calibrated(1.0), 1.0);
}

TEST(Calibration, SaysHowOftenTheNewestFrameWasRight) {
  // Section 6.4, below it, between, and from .9 on.
  for (const auto& [given, right] : {std::pair{-15.0, -2.6 - 0.3},
                                     {-14.0, -2.6},
                                     {-9.0, -2.1},
                                     {-6.0, -1.4},
                                     {-3.5, -0.65},
                                     {-1.75, 0.25},
                                     {-0.625, 0.725},
                                     {0.5, 1.2},
                                     {2.2, 2.2},
                                     {4.6, 4.6}}) {
    EXPECT_NEAR(log_odds(calibrated_now(given)), right, 1e-9) << given;
  }
}

TEST(Calibration, RisesWithTheOddsOfTheNewestFrame) {
  double before = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double odds = -30.0 + 0.036 * i;
    const double right = calibrated_now(odds);
    ASSERT_GT(right, before) << odds;
    ASSERT_LE(right, 1.0) << odds;
    before = right;
  }
  EXPECT_LT(calibrated_now(-1000.0), 1e-6);
}

}  // namespace
}  // namespace seqloop
