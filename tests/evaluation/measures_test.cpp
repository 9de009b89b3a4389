// SPDX-License-Identifier: MIT
#include "evaluation/measures.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "expect_setup_error.hpp"

namespace seqloop::evaluation {
namespace {

std::vector<Answer> read(const std::string& text,
                         ThresholdOn threshold_on = ThresholdOn::uniqueness) {
  return parse_answers(text, "m.csv", threshold_on);
}

/// Query i is answered by itself where it is right, far away where it is not.
Answer said(std::uint64_t query, double probability, bool right) {
  return {query, right ? query : query + 1000, -probability, probability};
}

Measures measured(const std::vector<Answer>& answers) {
  return measure(answers, Truth::identity(5000), 0, 5000);
}

/// The definition, bin by bin, without any running sum.
double naive_error(const std::vector<Answer>& answers, std::vector<std::uint64_t>& counts) {
  double error = 0.0;
  double said = 0.0;
  for (const Answer& answer : answers) said += std::isnan(answer.probability) ? 0.0 : 1.0;
  for (int bin = 0; bin < 10; ++bin) {
    std::vector<double> probabilities;
    double right = 0.0;
    for (const Answer& answer : answers) {
      const bool last = bin == 9 && answer.probability == 1.0;
      const bool inside = answer.probability >= bin / 10.0 && answer.probability < (bin + 1) / 10.0;
      if (!inside && !last) continue;
      probabilities.push_back(answer.probability);
      right += answer.match == answer.query ? 1.0 : 0.0;
    }
    counts.push_back(probabilities.size());
    if (probabilities.empty()) continue;
    const auto in_bin = static_cast<double>(probabilities.size());
    double mean = 0.0;
    for (const double probability : probabilities) mean += probability / in_bin;
    error += in_bin / said * std::abs(right / in_bin - mean);
  }
  return error;
}

TEST(CalibrationError, AgreesWithItsDefinition) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<Answer> answers;
    for (std::uint64_t query = 0; query < 4000; ++query) {
      // Whole tenths too, which are the edges of bins.
      double probability = uniform(random);
      if (query % 5 == 0) probability = std::round(probability * 10.0) / 10.0;
      if (query % 17 == 0) probability = std::nan("");
      answers.push_back(said(query, probability, uniform(random) < 0.2 + 0.5 * probability));
    }
    const Measures measures = measured(answers);
    std::vector<std::uint64_t> counts;
    EXPECT_NEAR(expected_calibration_error(measures.reliability), naive_error(answers, counts),
                1e-12);
    for (std::size_t bin = 0; bin < 10; ++bin) {
      EXPECT_EQ(measures.reliability[bin].count, counts[bin]) << bin;
    }
  }
}

TEST(CalibrationError, HasABinThatBeginsWithEachTenthFloatOrDouble) {
  std::vector<Answer> answers;
  for (std::uint64_t tenth = 0; tenth < 10; ++tenth) {
    const double probability = static_cast<double>(tenth) / 10.0;
    answers.push_back(said(2 * tenth, probability, true));
    answers.push_back(
        said(2 * tenth + 1, static_cast<double>(static_cast<float>(probability)), true));
  }
  for (const ReliabilityBin& bin : measured(answers).reliability) EXPECT_EQ(bin.count, 2U);
}

TEST(CalibrationError, OfNoAnswersIsNotDefined) {
  for (const auto& answers :
       {std::vector<Answer>{}, std::vector{said(3, std::nan(""), true), Answer{4, 4, 0.5}}}) {
    const Measures measures = measured(answers);
    EXPECT_TRUE(std::isnan(expected_calibration_error(measures.reliability)));
    EXPECT_EQ(measures.answered, answers.size());
    for (const ReliabilityBin& bin : measures.reliability) {
      EXPECT_EQ(bin.count, 0U);
      EXPECT_TRUE(std::isnan(bin.mean_probability()));
      EXPECT_TRUE(std::isnan(bin.share_right()));
    }
  }
}

TEST(CalibrationError, OfOneBinIsHowFarThatIsOff) {
  const Measures measures = measured(
      {said(0, 0.72, true), said(1, 0.74, false), said(2, 0.76, true), said(3, 0.78, true)});
  EXPECT_EQ(measures.reliability[7].count, 4U);
  EXPECT_DOUBLE_EQ(measures.reliability[7].mean_probability(), 0.75);
  EXPECT_DOUBLE_EQ(measures.reliability[7].share_right(), 0.75);
  EXPECT_NEAR(expected_calibration_error(measures.reliability), 0.0, 1e-12);
  const Measures sure = measured({said(0, 0.98, false), said(1, 0.96, false)});
  EXPECT_NEAR(expected_calibration_error(sure.reliability), 0.97, 1e-12);
}

TEST(CalibrationError, TakesExactlyNoneAndExactlyOne) {
  const Measures right = measured({said(0, 0.0, false), said(1, 1.0, true)});
  EXPECT_EQ(right.reliability[0].count, 1U);
  EXPECT_EQ(right.reliability[9].count, 1U);
  EXPECT_EQ(right.reliability[9].mean_probability(), 1.0);
  EXPECT_EQ(expected_calibration_error(right.reliability), 0.0);
  const Measures wrong = measured({said(0, 0.0, true), said(1, 1.0, false)});
  EXPECT_EQ(expected_calibration_error(wrong.reliability), 1.0);
}

TEST(CalibrationError, LeavesOutAnswersThatSayNothing) {
  const Measures measures = measured({said(0, 0.25, false), said(1, std::nan(""), true)});
  EXPECT_EQ(measures.answered, 2U);
  EXPECT_DOUBLE_EQ(expected_calibration_error(measures.reliability), 0.25);
}

TEST(Answers, ALargerProbabilityIsMoreCertain) {
  const std::string text =
      "query,match,probability\n1,1,0.9\n2,7,0.95\n3,3,0.99\n4,4,nan\n5,5,0.2\n";
  const auto answers = read(text, ThresholdOn::probability);
  const Measures measures = measure(answers, Truth::identity(10), 0, 10);
  EXPECT_DOUBLE_EQ(measures.recall_at_100_precision, 0.1) << "3 is right, then 2 is wrong";
  ASSERT_EQ(measures.curve.size(), 5U);
  EXPECT_DOUBLE_EQ(measures.curve[3].recall, 0.3);
  EXPECT_DOUBLE_EQ(measures.curve[4].recall, 0.4) << "what has no probability comes last";
  EXPECT_TRUE(test::says(
      test::setup_error([] { (void)read("query,match,score\n1,2,3\n", ThresholdOn::probability); }),
      "probability"));
}

TEST(Answers, RefuseWhatIsNoProbabilityOrAcceptance) {
  const auto refused = [](const std::string& row) {
    return test::setup_error(
        [&] { (void)read("query,match,uniqueness,probability,accepted\n" + row + "\n"); });
  };
  for (const char* row : {"1,2,3,1.5,0", "1,2,3,-0.1,0", "1,2,3,inf,0", "1,2,3,,0"}) {
    EXPECT_TRUE(test::says(refused(row), "m.csv:2")) << row;
    EXPECT_TRUE(test::says(refused(row), "probability")) << row;
  }
  for (const char* row : {"1,2,3,0.5,2", "1,2,3,0.5,yes", "1,2,3,0.5,", "1,2,3,0.5,0.5"}) {
    EXPECT_TRUE(test::says(refused(row), "0 or 1")) << row;
  }
}

TEST(Accepted, PrecisionAndRecall) {
  std::vector<Answer> answers{{0, 0, 0.1, 0.99, true},
                              {1, 9, 0.2, 0.99, true},
                              {2, 2, 0.3, 0.50, false},
                              {3, 3, 0.4, 0.99, true}};
  const Measures measures = measure(answers, Truth::identity(10), 2, 10);
  EXPECT_EQ(measures.accepted, 3U);
  EXPECT_DOUBLE_EQ(measures.accepted_precision, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(measures.accepted_recall, 0.2);
  for (Answer& answer : answers) answer.accepted = false;
  const Measures silent = measure(answers, Truth::identity(10), 2, 10);
  EXPECT_EQ(silent.accepted, 0U);
  EXPECT_TRUE(std::isnan(silent.accepted_precision));
  EXPECT_EQ(silent.accepted_recall, 0.0);
  answers[2].accepted.reset();
  const Measures unsaid = measure(answers, Truth::identity(10), 2, 10);
  EXPECT_FALSE(unsaid.accepted.has_value());
  EXPECT_TRUE(std::isnan(unsaid.accepted_recall));
}

TEST(Accepted, WhereNoPlaceComesTwiceEveryAnswerIsWrong) {
  const std::vector<Answer> answers{{7, 7, 0.1, 0.75, true}, {8, 2, 0.2, 0.25, false}};
  const Measures measures = measure(answers, Truth::no_revisit(), 2, 0);
  EXPECT_EQ(measures.answered, 2U);
  EXPECT_EQ(measures.correct, 0U);
  EXPECT_EQ(measures.recall, 0.0);
  EXPECT_EQ(measures.accepted, 1U);
  EXPECT_EQ(measures.accepted_precision, 0.0);
  EXPECT_TRUE(std::isnan(measures.accepted_recall)) << "there is nothing to recall";
  EXPECT_DOUBLE_EQ(expected_calibration_error(measures.reliability), 0.5);
}

TEST(Accepted, AnswersThatNobodyCanJudgeCountForNothing) {
  const CsvTable table("query,reference,tolerance\n5,1,0\n6,2,0\n", "t.csv");
  const std::vector<Answer> answers{
      {4, 9, 0.1, 0.9, true}, {5, 1, 0.2, 0.9, true}, {6, 9, 0.3, 0.9, true}, {7, 9, 0.4}};
  const Measures all = measure(answers, Truth::from_csv(table), 0, 2);
  EXPECT_EQ(all.answered, 4U);
  EXPECT_EQ(all.unknown, 0U);
  EXPECT_FALSE(all.accepted.has_value());
  const Measures listed = measure(answers, Truth::from_csv(table, Unlisted::unknown), 0, 2);
  EXPECT_EQ(listed.answered, 2U);
  EXPECT_EQ(listed.unknown, 2U);
  EXPECT_EQ(listed.accepted, 2U);
  EXPECT_DOUBLE_EQ(listed.accepted_precision, 0.5);
  EXPECT_DOUBLE_EQ(listed.accepted_recall, 0.5);
  EXPECT_DOUBLE_EQ(listed.recall_at_100_precision, 0.5);
  EXPECT_EQ(listed.reliability[9].count, 2U);
}

}  // namespace
}  // namespace seqloop::evaluation
