// Rivals of the frames before, where a frame sees only one slice of the map.
#include "seqloop/detail/past_rivals.hpp"

#include "core/matcher.hpp"

namespace seqloop {
namespace {

constexpr std::size_t slice = 100;
constexpr std::size_t two_slices = 2 * slice;  // stand for four frames
constexpr std::size_t half_window = 5;

MatcherConfig config(std::size_t sequence_length = 20) {
  MatcherConfig config;
  config.sequence_length = sequence_length;
  config.relocalising.slice = slice;
  return config;
}

struct PastRivalsOf {
  explicit PastRivalsOf(const MatcherConfig& config) : rivals(memory.arena, config) {}

  /// A frame that remembers one row.
  void frame(std::size_t row, double score) {
    rivals.next();
    rivals.remember({row, score});
  }

  TestArena memory;
  PastRivals rivals;
};

TEST(PastRivals, TheLowestOfTheFramesBeforeStands) {
  PastRivalsOf past(config());
  past.frame(50, 0.7);
  past.frame(80, 0.5);
  past.frame(120, 0.6);
  past.rivals.next();
  EXPECT_EQ(past.rivals.lowest(10, half_window, two_slices), 0.5);
}

TEST(PastRivals, NoneStandsBeforeTheFirstFrame) {
  PastRivalsOf past(config());
  past.rivals.next();
  EXPECT_EQ(past.rivals.lowest(10, half_window, two_slices), std::nullopt);
}

TEST(PastRivals, OneSliceShowsAllRivals) {
  PastRivalsOf past(config());
  past.frame(80, 0.5);
  past.rivals.next();
  for (const std::size_t rows : {std::size_t{0}, std::size_t{1}, slice}) {
    EXPECT_EQ(past.rivals.lowest(10, half_window, rows), std::nullopt) << rows;
  }
  EXPECT_EQ(past.rivals.lowest(10, half_window, slice + 1), 0.5);
}

TEST(PastRivals, StandForFourRoundsOfTheOtherSlices) {
  PastRivalsOf past(config());
  past.frame(80, 0.5);
  for (std::size_t age = 1; age <= 4; ++age) {
    past.rivals.next();
    EXPECT_EQ(past.rivals.lowest(10, half_window, two_slices), 0.5) << age;
  }
  past.rivals.next();
  EXPECT_EQ(past.rivals.lowest(10, half_window, two_slices), std::nullopt);
}

TEST(PastRivals, StandForHalfAWindowAtMost) {
  PastRivalsOf past(config());
  past.frame(80, 0.5);
  for (std::size_t age = 1; age <= 10; ++age) {
    past.rivals.next();
    EXPECT_EQ(past.rivals.lowest(10, half_window, 1000 * slice), 0.5) << age;
  }
  past.rivals.next();
  EXPECT_EQ(past.rivals.lowest(10, half_window, 1000 * slice), std::nullopt);
}

TEST(PastRivals, MoveAlongAndAreNoRivalsOfRowsThatTheyMayHaveReached) {
  PastRivalsOf past(config());
  past.frame(50, 0.5);
  past.rivals.next();
  past.rivals.next();
  // Two frames on: row 52, give or take the half window and two rows.
  EXPECT_TRUE(past.rivals.lowest(44, half_window, two_slices));
  for (std::size_t best = 45; best <= 59; ++best) {
    EXPECT_FALSE(past.rivals.lowest(best, half_window, two_slices)) << best;
  }
  EXPECT_TRUE(past.rivals.lowest(60, half_window, two_slices));
}

TEST(PastRivals, FramesThatWentByUnseenCount) {
  PastRivalsOf past(config());
  past.frame(80, 0.5);
  past.rivals.skip(3);
  past.rivals.next();
  EXPECT_TRUE(past.rivals.lowest(10, half_window, two_slices));
  past.rivals.skip(1);
  EXPECT_FALSE(past.rivals.lowest(10, half_window, two_slices));
}

TEST(PastRivals, ARemovedRowMovesThoseBehindIt) {
  PastRivalsOf past(config());
  past.frame(50, 0.5);
  past.rivals.removed(50);
  past.rivals.removed(70);
  past.rivals.next();
  EXPECT_TRUE(past.rivals.lowest(44, half_window, two_slices)) << "still row 51";
  past.rivals.removed(20);
  EXPECT_FALSE(past.rivals.lowest(44, half_window, two_slices)) << "row 50";
}

TEST(PastRivals, TheRingKeepsTwoAFrame) {
  PastRivalsOf past(config());
  past.frame(50, 0.1);
  for (std::size_t frame = 0; frame < 10; ++frame) {
    past.frame(100, 0.6);
    past.rivals.remember({150, 0.7});
  }
  EXPECT_EQ(past.rivals.lowest(10, half_window, 1000 * slice), 0.6) << "0.1 was overwritten";
}

TEST(PastRivals, ARestartForgetsAll) {
  PastRivalsOf past(config());
  past.frame(80, 0.5);
  past.rivals.restart();
  past.rivals.next();
  EXPECT_EQ(past.rivals.lowest(10, half_window, two_slices), std::nullopt);
}

TEST(PastRivals, SingleFramesAndFullSearchesKeepNone) {
  MatcherConfig full = config();
  full.relocalising.on = false;
  for (const MatcherConfig& each : {config(1), full}) {
    PastRivalsOf past(each);
    past.frame(80, 0.5);
    past.rivals.next();
    EXPECT_EQ(past.rivals.lowest(10, half_window, two_slices), std::nullopt);
  }
}

}  // namespace
}  // namespace seqloop
