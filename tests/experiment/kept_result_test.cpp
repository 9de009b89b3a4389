// SPDX-License-Identifier: MIT
#include "experiment/run/kept_result.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "experiment/synthetic_result.hpp"
#include "temporary_folder.hpp"

namespace seqloop::experiment {
namespace {

Result kept_and_read(const Result& result) {
  const test::TemporaryFolder folder;
  keep_result(result, folder.path() / "r.json");
  const std::optional<Result> read = kept_result(folder.path() / "r.json");
  EXPECT_TRUE(read.has_value());
  return read.value_or(Result{});
}

TEST(KeptResult, HoldsWhatIsNotDefined) {
  const Result read = kept_and_read(synthetic_result("p", "m", "d", {}, 0.0));
  EXPECT_FALSE(read.measures.accepted.has_value());
  EXPECT_TRUE(std::isnan(read.measures.accepted_precision));
  EXPECT_TRUE(std::isnan(read.measures.accepted_recall));
  EXPECT_TRUE(std::isnan(expected_calibration_error(read.measures.reliability)));
}

TEST(KeptResult, HoldsHowReliableAnswersAre) {
  Result result = synthetic_result("p", "m", "d", {}, 0.0);
  result.measures.accepted = 0;
  result.measures.accepted_recall = 1.0 / 3.0;
  result.measures.reliability[7] = {9, 6, 9 * 0.7123456789};
  const Result read = kept_and_read(result);
  EXPECT_EQ(read.measures.accepted, 0U);
  EXPECT_EQ(read.measures.accepted_recall, 1.0 / 3.0);
  EXPECT_EQ(read.measures.reliability[7].count, 9U);
  EXPECT_EQ(read.measures.reliability[7].right, 6U);
  EXPECT_EQ(read.measures.reliability[7].probability_sum, 9 * 0.7123456789);
}

}  // namespace
}  // namespace seqloop::experiment
