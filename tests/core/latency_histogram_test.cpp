// SPDX-License-Identifier: MIT
// Quantiles beside the sorted list.
#include "seqloop/latency_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace seqloop {
namespace {

TEST(LatencyHistogram, QuantilesAreWithinABucketOfTheSortedList) {
  std::mt19937_64 random(3);
  std::lognormal_distribution<double> durations(12.0, 3.0);
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5).count(), 0);
  std::vector<std::int64_t> all;
  for (int i = 0; i < 5000; ++i) {
    all.push_back(static_cast<std::int64_t>(durations(random)));
    histogram.add(Nanoseconds(all.back()));
  }
  std::sort(all.begin(), all.end());
  for (const double share : {0.001, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * 5000.0)) - 1;
    const auto exact = static_cast<double>(all[rank]);
    const auto given = static_cast<double>(histogram.quantile(share).count());
    EXPECT_GE(given, exact) << share;
    EXPECT_LE(given, exact * (1.0 + 1.0 / 32.0) + 1.0) << share;
  }
  EXPECT_EQ(histogram.maximum().count(), all.back());
}

TEST(LatencyHistogram, TakesTheLongestAndTheImpossible) {
  LatencyHistogram histogram;
  histogram.add(Nanoseconds::max());
  histogram.add(Nanoseconds(-5));
  EXPECT_EQ(histogram.quantile(1.0), Nanoseconds::max());
  EXPECT_EQ(histogram.quantile(0.5), Nanoseconds(0));
  EXPECT_EQ(histogram.quantile(2.0), Nanoseconds::max());
  EXPECT_EQ(histogram.quantile(-1.0), Nanoseconds(0));
  EXPECT_EQ(histogram.quantile(std::numeric_limits<double>::quiet_NaN()), Nanoseconds(0));
}

}  // namespace
}  // namespace seqloop
