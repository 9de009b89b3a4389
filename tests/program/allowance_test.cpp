// SPDX-License-Identifier: MIT
#include "program/fleet/allowance.hpp"

#include <gtest/gtest.h>

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;

TEST(Allowance, IsKeptOnAverageAndOneSecondsAtATime) {
  for (const double kbps : {8.0, 80.0, 1000.0}) {
    for (const std::size_t size : {1U, 100U, 3000U}) {
      Allowance::Clock::time_point now{};
      Allowance allowance(kbps, now);
      const double a_second = kbps * 125.0;
      double sent = 0.0;
      for (int round = 0; round < 3000; ++round, now += 20ms) {
        // Nothing to send for the second third of a minute: that is not made up for later.
        if (round >= 1000 && round < 2000) continue;
        while (allowance.left(now)) {
          allowance.spend(size);
          sent += static_cast<double>(size);
        }
        const double seconds = 0.02 * (round < 1000 ? round : round - 1000 + 50);
        ASSERT_LE(sent, a_second * (seconds + 1.0) + 2.0 * static_cast<double>(size)) << round;
      }
      EXPECT_GE(sent, a_second * 40.0 - static_cast<double>(size));
    }
  }
}

TEST(Allowance, OfNoneThereIsNoLimit) {
  Allowance::Clock::time_point now{};
  Allowance allowance(0.0, now);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(allowance.left(now));
    allowance.spend(1'000'000);
  }
}

}  // namespace
}  // namespace seqloop::program
