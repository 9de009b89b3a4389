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
  for (const auto& [given, right] : {std::pair{-5.6, -1.25 - 0.31},
                                     {-4.6, -1.25},
                                     {-1.4, -0.5},
                                     {-0.3, -0.42},
                                     {0.8, 0.0},
                                     {1.5, 0.3},
                                     {2.2, 0.6},
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

}  // namespace
}  // namespace seqloop
