// SPDX-License-Identifier: MIT
// The detector against the definitions, over many shapes, in both uses and for every method.
#include <cmath>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

std::string label(const MatcherConfig& config, std::uint32_t seed) {
  return "seed " + std::to_string(seed) + ", ds " + std::to_string(config.sequence_length) +
         ", method " + std::to_string(static_cast<int>(config.candidates)) + ", k " +
         std::to_string(config.k) + ", num " + std::to_string(config.num) + ", rwindow " +
         std::to_string(config.rwindow) + ", reinit " + std::to_string(config.reinit) +
         ", arithmetic " + std::to_string(static_cast<int>(config.arithmetic)) + ", v " +
         std::to_string(config.vmin) + " to " + std::to_string(config.vmax) + ", exclude " +
         std::to_string(config.exclude);
}

void expect_same(const oracle::Vectors& reference, const oracle::Vectors& query,
                 const MatcherConfig& config, std::uint32_t seed, std::size_t& answered) {
  SCOPED_TRACE(label(config, seed));
  const std::vector<oracle::Answer> wanted = oracle::match(reference, query, config);
  std::size_t next = 0;
  for (const FrameReport& report : reports(reference, query, config)) {
    if (!report.match) continue;
    ASSERT_LT(next, wanted.size());
    const oracle::Answer& answer = wanted[next++];
    const Match& match = *report.match;
    ASSERT_EQ(static_cast<std::int64_t>(*report.frame), answer.query);
    ASSERT_EQ(static_cast<std::int64_t>(match.place), answer.match) << "frame " << answer.query;
    if (config.arithmetic == Arithmetic::float32) {
      EXPECT_NEAR(match.score, answer.score, 1e-5);
    } else {
      ASSERT_EQ(match.score, static_cast<float>(answer.score)) << "frame " << answer.query;
    }
    if (std::isnan(answer.uniqueness)) {
      EXPECT_TRUE(std::isnan(match.uniqueness));
    } else if (std::isinf(answer.uniqueness)) {
      EXPECT_TRUE(std::isinf(match.uniqueness));
    } else {
      EXPECT_NEAR(match.uniqueness, answer.uniqueness, 1e-5);
    }
    if (config.sequence_length > 0) {
      EXPECT_EQ(match.velocity, answer.velocity);
    } else {
      EXPECT_TRUE(std::isnan(match.velocity));
    }
    EXPECT_EQ(static_cast<std::int64_t>(match.head), answer.head);
    ASSERT_EQ(match.runner_up.has_value(), answer.runner_up.has_value())
        << "frame " << answer.query;
    if (match.runner_up) {
      EXPECT_EQ(static_cast<std::int64_t>(*match.runner_up), *answer.runner_up) << answer.query;
    }
    EXPECT_EQ(static_cast<std::int64_t>(report.work.candidates), answer.candidates);
    EXPECT_EQ(static_cast<std::int64_t>(report.k), answer.k);
  }
  EXPECT_EQ(next, wanted.size());
  answered += next;
}

class DetectorOracle : public testing::TestWithParam<Candidates> {};

TEST_P(DetectorOracle, LocalisesAsDefined) {
  std::size_t answered = 0;
  std::uint32_t seed = 1;
  for (const std::size_t ds : {1U, 2U, 3U, 5U, 10U, 11U, 20U, 30U}) {
    for (const std::size_t size : {1U, 15U, 16U, 17U, 40U}) {
      const std::size_t places = 20 + 7 * (seed % 13);
      const std::size_t frames = 31 + 11 * (seed % 9);
      MatcherConfig config = paper(GetParam(), ds);
      config.k = 1 + seed % 7;
      config.initial_k = 1 + seed % 11;
      config.num = 1 + seed % 17;
      config.rwindow = seed % 12;
      config.reinit = 1 + seed % 40;
      expect_same(oracle::drive(seed, places, size, 0.3F), oracle::drive(seed, frames, size, 0.4F),
                  config, seed, answered);
      ++seed;
    }
  }
  EXPECT_GT(answered, 1000U);
}

TEST_P(DetectorOracle, SearchesMapsLargerThanABlock) {
  std::size_t answered = 0;
  MatcherConfig config = paper(GetParam(), 12);
  config.num = 200;
  expect_same(oracle::drive(50, 700, 8, 0.3F), oracle::drive(50, 60, 8, 0.4F), config, 50,
              answered);
  EXPECT_EQ(answered, 48U);
}

TEST_P(DetectorOracle, ClosesLoopsAsDefined) {
  std::size_t answered = 0;
  std::uint32_t seed = 100;
  for (const std::size_t ds : {1U, 4U, 7U, 20U, 40U}) {
    for (const std::size_t exclude : {1U, 5U, 30U, 60U}) {
      oracle::Vectors lap = oracle::drive(seed, 90, 24, 0.3F);
      const oracle::Vectors again = oracle::drive(seed, 90, 24, 0.4F);
      lap.insert(lap.end(), again.begin(), again.end());
      MatcherConfig config = paper(GetParam(), ds, Use::close_loops);
      config.exclude = exclude;
      config.reinit = 25;
      config.num = 4 + seed % 5;
      expect_same({}, lap, config, seed, answered);
      ++seed;
    }
  }
  EXPECT_GT(answered, 1000U);
}

TEST_P(DetectorOracle, EnhancesAndComparesPatchesAsDefined) {
  std::size_t answered = 0;
  std::uint32_t seed = 200;
  for (const Difference difference : {Difference::euclidean, Difference::mean_absolute}) {
    for (const bool enhance : {false, true}) {
      for (const std::size_t ds : {0U, 1U, 6U, 21U}) {
        MatcherConfig config = paper(GetParam(), ds);
        config.difference = difference;
        config.enhance = enhance;
        config.rwindow = 2 + seed % 14;
        config.reinit = 1 + seed % 40;
        config.num = 1 + seed % 17;
        expect_same(oracle::drive(seed, 7 + seed % 60, 33, 0.3F), oracle::drive(seed, 70, 33, 0.4F),
                    config, seed, answered);
        ++seed;
      }
    }
  }
  EXPECT_GT(answered, 500U);
}

TEST_P(DetectorOracle, ClosesLoopsWithEnhancementAsDefined) {
  std::size_t answered = 0;
  std::uint32_t seed = 300;
  for (const std::size_t ds : {0U, 5U, 20U, 40U}) {
    for (const std::size_t exclude : {6U, 10U, 30U}) {
      MatcherConfig config = paper(GetParam(), ds, Use::close_loops);
      config.enhance = true;
      config.vmin = exclude == 10 ? 0.0 : 0.8;  // lines that reach far below the window's places
      config.exclude = exclude;
      config.reinit = 25;
      expect_same({}, oracle::drive(seed, 150, 24, 0.3F), config, seed, answered);
      ++seed;
    }
  }
  EXPECT_GT(answered, 400U);
}

TEST_P(DetectorOracle, KeepsTiesInOrderWhenTheRobotStands) {
  // Standing still makes equal rows: the lower row and the slower line must win.
  std::size_t answered = 0;
  oracle::Vectors reference = oracle::drive(7, 80, 8, 0.1F);
  for (std::size_t i = 30; i < 45; ++i) reference[i] = reference[30];
  oracle::Vectors query = reference;
  for (std::size_t i = 50; i < 70; ++i) query[i] = query[50];
  expect_same(reference, query, paper(GetParam(), 10), 7, answered);
  EXPECT_GT(answered, 50U);
}

TEST_P(DetectorOracle, AnswersNothingWhenNoLineFits) {
  const oracle::Vectors query = oracle::drive(3, 40, 8);
  for (const std::size_t places : {1U, 2U, 16U, 17U}) {
    std::size_t answered = 0;
    expect_same(oracle::drive(3, places, 8), query, paper(GetParam(), 20), 3, answered);
    EXPECT_EQ(answered == 0, places < 17) << places;
  }
}

/// A drive that stands still for a while, so that equal places come one after the other.
oracle::Vectors halting_drive(std::uint32_t seed, std::size_t frames, float noise) {
  oracle::Vectors drive = oracle::drive(seed, frames, 24, noise);
  const std::size_t halt = frames / 3;
  for (std::size_t frame = halt; frame < halt + frames / 4; ++frame) drive[frame] = drive[halt];
  return drive;
}

// In whole numbers the detector and the definitions agree to the last bit.
TEST_P(DetectorOracle, AnswersInWholeNumbersExactlyAsDefined) {
  std::size_t answered = 0;
  std::uint32_t seed = 400;
  for (const Arithmetic arithmetic : {Arithmetic::int8, Arithmetic::sketch}) {
    for (const std::size_t ds : {0U, 1U, 2U, 5U, 12U, 20U, 41U}) {
      for (const auto& [vmin, vmax] :
           {std::pair{0.8, 1.2}, std::pair{0.0, 2.0}, std::pair{1.0, 1.0}, std::pair{0.5, 3.0}}) {
        for (const std::size_t places : {1U, 2U, 127U, 128U, 129U}) {
          MatcherConfig config = paper(GetParam(), ds);
          config.arithmetic = arithmetic;
          config.vmin = vmin;
          config.vmax = vmax;
          config.reinit = 40;
          config.rwindow = seed % 12;
          expect_same(halting_drive(seed, places, 0.3F), halting_drive(seed, 50, 0.4F), config,
                      seed, answered);
          if (HasFatalFailure()) return;
          ++seed;
        }
        MatcherConfig config = paper(GetParam(), ds, Use::close_loops);
        config.arithmetic = arithmetic;
        config.vmin = vmin;
        config.vmax = vmax;
        config.reinit = 40;
        config.exclude = 1 + seed % 40;
        oracle::Vectors laps = halting_drive(seed, 70, 0.2F);
        for (const auto& seen : halting_drive(seed, 70, 0.3F)) laps.push_back(seen);
        expect_same({}, laps, config, seed, answered);
        if (HasFatalFailure()) return;
        ++seed;
      }
    }
  }
  EXPECT_GT(answered, 9'000U);
}

TEST_P(DetectorOracle, SearchesLargeMapsInWholeNumbersExactlyAsDefined) {
  std::size_t answered = 0;
  for (const Arithmetic arithmetic : {Arithmetic::int8, Arithmetic::sketch}) {
    for (const std::size_t ds : {0U, 12U, 41U}) {
      MatcherConfig config = paper(GetParam(), ds);
      config.arithmetic = arithmetic;
      expect_same(halting_drive(700, 300, 0.3F), halting_drive(700, 80, 0.4F), config, 700,
                  answered);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_EQ(answered, 2 * (80 + 68 + 39U));
}

INSTANTIATE_TEST_SUITE_P(Methods, DetectorOracle,
                         testing::Values(Candidates::all, Candidates::ranges,
                                         Candidates::adaptive));

}  // namespace
}  // namespace seqloop
