// SPDX-License-Identifier: MIT
// Runners-up of the frames before, where a frame scans only a part of the map.
#include "seqloop/detail/runner_up_history.hpp"

#include "core/matcher.hpp"

namespace seqloop {
namespace {

constexpr std::size_t scan = 100;
constexpr std::size_t two_scans = 2 * scan;  // stand for four frames
constexpr std::size_t half_rwindow = 5;

MatcherConfig config(std::size_t sequence_length = 20) {
  MatcherConfig config;
  config.sequence_length = sequence_length;
  config.relocalising.rows_scanned = scan;
  return config;
}

// Rows of one session.
constexpr CandidateRun any{0, 100'000};

struct HistoryOf {
  explicit HistoryOf(const MatcherConfig& config) : history(memory.arena, config) {}

  /// A frame that remembers one row.
  void frame(std::size_t row, double score) {
    history.next();
    history.remember({row, score});
  }

  TestArena memory;
  RunnerUpHistory history;
};

TEST(RunnerUpHistory, TheLowestOfTheFramesBeforeStands) {
  HistoryOf past(config());
  past.frame(50, 0.7);
  past.frame(80, 0.5);
  past.frame(120, 0.6);
  past.history.next();
  EXPECT_EQ(past.history.lowest(10, half_rwindow, two_scans, any), 0.5);
}

TEST(RunnerUpHistory, NoneStandsBeforeTheFirstFrame) {
  HistoryOf past(config());
  past.history.next();
  EXPECT_EQ(past.history.lowest(10, half_rwindow, two_scans, any), std::nullopt);
}

TEST(RunnerUpHistory, OneScanShowsEveryRunnerUp) {
  HistoryOf past(config());
  past.frame(80, 0.5);
  past.history.next();
  for (const std::size_t rows : {std::size_t{0}, std::size_t{1}, scan}) {
    EXPECT_EQ(past.history.lowest(10, half_rwindow, rows, any), std::nullopt) << rows;
  }
  EXPECT_EQ(past.history.lowest(10, half_rwindow, scan + 1, any), 0.5);
}

TEST(RunnerUpHistory, StandsForFourRoundsOfTheOtherScans) {
  HistoryOf past(config());
  past.frame(80, 0.5);
  for (std::size_t age = 1; age <= 4; ++age) {
    past.history.next();
    EXPECT_EQ(past.history.lowest(10, half_rwindow, two_scans, any), 0.5) << age;
  }
  past.history.next();
  EXPECT_EQ(past.history.lowest(10, half_rwindow, two_scans, any), std::nullopt);
}

TEST(RunnerUpHistory, StandsForHalfAWindowAtMost) {
  HistoryOf past(config());
  past.frame(80, 0.5);
  for (std::size_t age = 1; age <= 10; ++age) {
    past.history.next();
    EXPECT_EQ(past.history.lowest(10, half_rwindow, 1000 * scan, any), 0.5) << age;
  }
  past.history.next();
  EXPECT_EQ(past.history.lowest(10, half_rwindow, 1000 * scan, any), std::nullopt);
}

TEST(RunnerUpHistory, MovesAlongAndSparesRowsThatItMayHaveReached) {
  HistoryOf past(config());
  past.frame(50, 0.5);
  past.history.next();
  past.history.next();
  // Two frames on: row 52, give or take the half window and two rows.
  EXPECT_TRUE(past.history.lowest(44, half_rwindow, two_scans, any));
  for (std::size_t best = 45; best <= 59; ++best) {
    EXPECT_FALSE(past.history.lowest(best, half_rwindow, two_scans, any)) << best;
  }
  EXPECT_TRUE(past.history.lowest(60, half_rwindow, two_scans, any));
}

TEST(RunnerUpHistory, FramesThatWentByUnseenCount) {
  HistoryOf past(config());
  past.frame(80, 0.5);
  past.history.skip(3);
  past.history.next();
  EXPECT_TRUE(past.history.lowest(10, half_rwindow, two_scans, any));
  past.history.skip(1);
  EXPECT_FALSE(past.history.lowest(10, half_rwindow, two_scans, any));
}

TEST(RunnerUpHistory, ARemovedRowMovesThoseBehindIt) {
  HistoryOf past(config());
  past.frame(50, 0.5);
  past.history.removed(50);
  past.history.removed(70);
  past.history.next();
  EXPECT_TRUE(past.history.lowest(44, half_rwindow, two_scans, any)) << "still row 51";
  past.history.removed(20);
  EXPECT_FALSE(past.history.lowest(44, half_rwindow, two_scans, any)) << "row 50";
}

TEST(RunnerUpHistory, TheRingKeepsTwoAFrame) {
  HistoryOf past(config());
  past.frame(50, 0.1);
  for (std::size_t frame = 0; frame < 10; ++frame) {
    past.frame(100, 0.6);
    past.history.remember({150, 0.7});
  }
  EXPECT_EQ(past.history.lowest(10, half_rwindow, 1000 * scan, any), 0.6) << "0.1 was overwritten";
}

TEST(RunnerUpHistory, ARestartForgetsAll) {
  HistoryOf past(config());
  past.frame(80, 0.5);
  past.history.restart();
  past.history.next();
  EXPECT_EQ(past.history.lowest(10, half_rwindow, two_scans, any), std::nullopt);
}

TEST(RunnerUpHistory, SingleFramesAndFullSearchesKeepNone) {
  MatcherConfig full = config();
  full.relocalising.on = false;
  for (const MatcherConfig& each : {config(1), full}) {
    HistoryOf past(each);
    past.frame(80, 0.5);
    past.history.next();
    EXPECT_EQ(past.history.lowest(10, half_rwindow, two_scans, any), std::nullopt);
  }
}

}  // namespace
}  // namespace seqloop
