// SPDX-License-Identifier: MIT
// What counts as a jump, and what does not.
#include "seqloop/detail/jump_rate.hpp"

#include <vector>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

constexpr std::uint64_t all_belong = 0;

/// A map of sessions of so many places each.
PlaceMap map_of(const std::vector<std::size_t>& sessions) {
  MatcherConfig config;
  config.standardisation.on = false;
  std::size_t places = 0;
  for (const std::size_t session : sessions) places += session;
  PlaceMap map(config, {places, 4, sessions.size()});
  const std::vector<float> descriptor{1.0F, 2.0F, 3.0F, 4.0F};
  for (const std::size_t session : sessions) {
    EXPECT_TRUE(map.begin_session());
    for (std::size_t i = 0; i < session; ++i) EXPECT_TRUE(map.add(descriptor));
  }
  return map;
}

TEST(JumpRate, IsNoneWhereEachAnswerLeadsOnToTheNext) {
  const PlaceMap map = map_of({400});
  JumpRate rate;
  std::uint64_t frame = 0;
  std::size_t row = 0;
  // Stands, drives at twice the pace, and is not seen for fifty frames.
  for (; frame < 30; ++frame) rate.take(map, frame, row, all_belong);
  for (; frame < 130; ++frame) rate.take(map, frame, row += 2, all_belong);
  rate.take(map, frame += 50, row += 100, all_belong);
  // Answers may be off by some rows.
  rate.take(map, ++frame, row - 20, all_belong);
  rate.take(map, ++frame, row, all_belong);
  EXPECT_EQ(rate.chance(), 0.0);
}

TEST(JumpRate, IsFourteenTimesTheJumpsPerAnswerAndThreeHundred) {
  const PlaceMap map = map_of({400});
  JumpRate rate;
  EXPECT_EQ(rate.chance(), 0.0);
  rate.take(map, 0, 100, all_belong);
  rate.take(map, 1, 123, all_belong);  // two on, and more than twenty off
  EXPECT_DOUBLE_EQ(rate.chance(), 14.0 * 1.0 / 302.0);
  rate.take(map, 2, 102, all_belong);  // back by more than twenty
  EXPECT_DOUBLE_EQ(rate.chance(), 14.0 * 2.0 / 303.0);
  for (std::uint64_t frame = 3; frame < 200; ++frame) {
    rate.take(map, frame, frame % 2 == 0 ? 10 : 300, all_belong);
  }
  EXPECT_EQ(rate.chance(), 0.5);
}

TEST(JumpRate, PassesOverAnswersThatComeLate) {
  const PlaceMap map = map_of({400});
  JumpRate rate;
  rate.take(map, 50, 300, all_belong);
  rate.take(map, 20, 10, all_belong);
  rate.take(map, 51, 301, all_belong);
  EXPECT_EQ(rate.chance(), 0.0);
}

TEST(JumpRate, KnowsNothingOfTheWayThroughAGap) {
  const PlaceMap map = map_of({400});
  JumpRate rate;
  rate.take(map, 50, 10, all_belong);
  rate.take(map, 60, 300, 55);
  EXPECT_EQ(rate.chance(), 0.0);
  rate.take(map, 61, 10, 55);
  EXPECT_GT(rate.chance(), 0.0);
}

bool is_jump(const PlaceMap& map, std::size_t from, std::size_t to, std::uint64_t frames) {
  JumpRate rate;
  rate.take(map, 0, from, all_belong);
  rate.take(map, frames, to, all_belong);
  return rate.chance() > 0.0;
}

TEST(JumpRate, IsNoneBetweenVisitsOfOnePlace) {
  // Rows 60 to 119 of the first session, and 40 to 99 of the second, 200 on.
  PlaceMap map = map_of({200, 200});
  for (std::size_t i = 0; i < 60; ++i) map.link(240 + i, 60 + i);
  EXPECT_FALSE(is_jump(map, 90, 272, 1)) << "the same place";
  EXPECT_FALSE(is_jump(map, 272, 90, 1)) << "and back";
  EXPECT_FALSE(is_jump(map, 90, 270, 30)) << "it has stood there";
  EXPECT_TRUE(is_jump(map, 90, 350, 1)) << "a place of the second session alone";
  // Only where the drive has led on to is a visit, or where it came from.
  EXPECT_FALSE(is_jump(map, 40, 250, 30));
  EXPECT_TRUE(is_jump(map, 40, 250, 1));
  EXPECT_FALSE(is_jump(map, 110, 320, 30));
  EXPECT_TRUE(is_jump(map, 110, 320, 1));
}

// A lap is linked as exactly as answers are: to some rows.
TEST(JumpRate, IsNoneBetweenVisitsThatAreLinkedSomeRowsOff) {
  for (const std::size_t rows : {0U, 15U, 19U, 20U, 21U, 22U, 45U}) {
    SCOPED_TRACE(rows);
    // Two later laps know rows 60 to 119 of the first one, one of them that many rows off.
    PlaceMap map = map_of({200, 200, 200});
    for (std::size_t i = 0; i < 60; ++i) map.link(240 + i, 60 + i);
    for (std::size_t i = 0; i + rows < 60; ++i) map.link(440 + i, 60 + i + rows);
    // From 65 to 66 and as many, and back.
    EXPECT_EQ(is_jump(map, 245, 446, 1), rows + 1 > 22);
    EXPECT_EQ(is_jump(map, 446, 245, 1), rows + 1 > 20);
    EXPECT_FALSE(is_jump(map, 245, 446, 30)) << "it may have driven faster";
  }
}

TEST(JumpRate, IsNoneIntoAnotherLapThatIsLinkedSomeRowsOff) {
  // Two laps more, of 100 rows each, that are linked to the first one.
  PlaceMap map = map_of({300});
  for (std::size_t i = 0; i < 200; ++i) map.link(100 + i, i % 100);
  // The drive leads from the end of the second lap to row 205, which is 5, and as many off.
  EXPECT_FALSE(is_jump(map, 195, 115, 10));
  EXPECT_FALSE(is_jump(map, 195, 125, 10));
  EXPECT_TRUE(is_jump(map, 195, 126, 10));
}

TEST(JumpRate, IsNoneFromTheEndOfASessionToTheBeginningOfOne) {
  const PlaceMap map = map_of({200, 200});
  // A lap, and a road that goes on in another session.
  EXPECT_FALSE(is_jump(map, 195, 3, 2));
  EXPECT_FALSE(is_jump(map, 195, 203, 2));
  EXPECT_FALSE(is_jump(map, 180, 20, 30));
  EXPECT_TRUE(is_jump(map, 180, 20, 5));
  EXPECT_TRUE(is_jump(map, 195, 100, 2));
}

TEST(JumpRate, IsNoneAfterALongTime) {
  const PlaceMap map = map_of({1000});
  EXPECT_TRUE(is_jump(map, 500, 100, 120));
  EXPECT_FALSE(is_jump(map, 500, 100, 121));
}

TEST(JumpRate, KeepsItsRowAsOthersCome) {
  const PlaceMap map = map_of({400});
  for (const bool told : {true, false}) {
    SCOPED_TRACE(told);
    JumpRate rate;
    rate.take(map, 0, 100, all_belong);
    for (std::size_t i = 0; told && i < 60; ++i) rate.inserted(i);
    rate.take(map, 1, 160, all_belong);
    EXPECT_EQ(rate.chance() == 0.0, told);
  }
}

}  // namespace
}  // namespace seqloop
