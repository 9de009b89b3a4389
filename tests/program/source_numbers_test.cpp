// SPDX-License-Identifier: MIT
#include "program/drives/source_numbers.hpp"

#include <gtest/gtest.h>

#include <array>

#include "core/oracle.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::program {
namespace {

MatcherConfig config(std::size_t patience = 3) {
  MatcherConfig config;
  config.sequence_length = 4;
  config.patience = patience;
  return config;
}

/// A map that has taken frames, each with a descriptor of its own, and may have forgotten some.
PlaceMap map_of(std::size_t capacity, std::size_t frames, FullMap full_map = FullMap::refuse) {
  constexpr std::size_t size = 16;
  MatcherConfig closing = config();
  closing.use = Use::close_loops;
  closing.exclude = 1;
  closing.full_map = full_map;
  PlaceMap map(closing, {capacity, size});
  Detector detector(closing, map);
  for (const auto& descriptor : oracle::drive(1, frames, size)) {
    static_cast<void>(detector.step(descriptor));
  }
  return map;
}

ProcessedFrame processed(std::uint64_t index, std::uint64_t counted) {
  ProcessedFrame frame;
  frame.frame.index = index;
  frame.report.gate = Gate::match;
  frame.report.newest = counted;
  if (counted >= 2) frame.report.frame = counted - 2;
  return frame;
}

Answer about(std::uint64_t frame, const std::optional<Match>& match = {}) {
  Answer answer;
  answer.frame = frame;
  answer.match = match;
  return answer;
}

TEST(SourceNumbers, AreTheDetectorsOwnWhereNothingIsMissing) {
  const PlaceMap map = map_of(100, 50);
  SourceNumbers numbers(config(), &map);
  ProcessedFrame first = processed(49, 49);  // all 50 came at once
  numbers.rename(first);
  ProcessedFrame frame = processed(50, 50);
  frame.report.match = Match{.place = 10, .head = 12};
  const std::array answers{about(46, Match{.place = 9, .head = 11}), about(50)};
  frame.report.answers = answers;
  frame.report.now = Belief{.place = 14};
  numbers.rename(frame);
  EXPECT_EQ(frame.report.newest, 50U);
  EXPECT_EQ(frame.report.frame, 48U);
  EXPECT_EQ(frame.report.match->place, 10U);
  EXPECT_EQ(frame.report.match->head, 12U);
  ASSERT_EQ(frame.report.answers.size(), 2U);
  EXPECT_EQ(frame.report.answers[0].frame, 46U);
  EXPECT_EQ(frame.report.answers[0].match->place, 9U);
  EXPECT_EQ(frame.report.answers[0].match->head, 11U);
  EXPECT_EQ(frame.report.answers[1].frame, 50U);
  EXPECT_FALSE(frame.report.answers[1].match);
  EXPECT_EQ(frame.report.now->place, 14U);
}

TEST(SourceNumbers, CountShortGapsAndLongOnes) {
  MatcherConfig closing = config();
  closing.use = Use::close_loops;
  closing.exclude = 1;
  const auto drive = oracle::drive(1, 5, 16);
  PlaceMap map(closing, {100, 16});
  Detector detector(closing, map);
  SourceNumbers numbers(closing, &map);
  static_cast<void>(detector.step(drive[0]));
  ProcessedFrame first = processed(7, 0);  // a live source that was late
  numbers.rename(first);
  EXPECT_EQ(first.report.newest, 7U);
  for (const std::size_t frame : {1U, 2U, 3U}) static_cast<void>(detector.step(drive[frame]));
  ProcessedFrame second = processed(10, 3);  // 8 and 9 never came; the detector counted them
  numbers.rename(second);
  EXPECT_EQ(second.report.newest, 10U);
  EXPECT_EQ(second.report.frame, 8U);
  static_cast<void>(detector.step(drive[4]));
  ProcessedFrame third = processed(500, 4);  // the detector left the gap out
  third.report.match = Match{.place = 1, .head = 4, .runner_up = 0};
  const std::array answers{about(0), about(3), about(4)};
  third.report.answers = answers;
  third.report.now = Belief{.place = 4};
  numbers.rename(third);
  EXPECT_EQ(third.report.newest, 500U);
  EXPECT_EQ(third.report.frame, 9U);
  EXPECT_EQ(third.report.answers[0].frame, 7U);
  EXPECT_EQ(third.report.answers[1].frame, 10U);
  EXPECT_EQ(third.report.answers[2].frame, 500U);
  EXPECT_EQ(third.report.match->place, 8U);
  EXPECT_EQ(third.report.match->head, 500U);
  EXPECT_EQ(third.report.match->runner_up, 7U);
  EXPECT_EQ(third.report.now->place, 500U);
  const std::array rest{about(2), about(4, Match{.place = 3})};
  const std::span<const Answer> renamed = numbers.rename(rest);
  EXPECT_EQ(renamed[0].frame, 9U);
  EXPECT_EQ(renamed[1].frame, 500U);
  EXPECT_EQ(renamed[1].match->place, 10U);
}

TEST(SourceNumbers, ReachBackAsFarAsAFrameMayWait) {
  for (const std::size_t patience : {0U, 1U, 30U, 1000U}) {
    SourceNumbers numbers(config(patience), nullptr);
    for (std::uint64_t counted = 0; counted < 2000; ++counted) {
      ProcessedFrame frame = processed(2 * counted, counted);
      // As many may be skipped, just before this one, as the window is long.
      const std::uint64_t back = std::min<std::uint64_t>(counted, patience + 5);
      const std::array answers{about(counted - back), about(counted)};
      frame.report.answers = answers;
      numbers.rename(frame);
      ASSERT_EQ(frame.report.answers[0].frame, 2 * (counted - back));
      ASSERT_EQ(frame.report.answers[1].frame, 2 * counted);
    }
  }
}

// Places that are in the map keep their numbers, whatever has gone.
TEST(SourceNumbers, OfAMapThatForgets) {
  for (const FullMap full_map : {FullMap::forget_oldest, FullMap::thin}) {
    constexpr std::size_t size = 16;
    MatcherConfig closing = config();
    closing.use = Use::close_loops;
    closing.exclude = 1;
    closing.full_map = full_map;
    PlaceMap map(closing, {30, size});
    Detector detector(closing, map);
    SourceNumbers numbers(closing, &map);
    std::uint64_t counted = 0;
    for (const auto& descriptor : oracle::drive(1, 500, size)) {
      static_cast<void>(detector.step(descriptor));
      ProcessedFrame frame = processed(counted + 1000, counted);
      const auto row = static_cast<std::size_t>((counted * 7) % map.size());
      const auto place = static_cast<std::size_t>(map.order().number(row));
      frame.report.match = Match{.place = place, .head = place};
      numbers.rename(frame);
      ASSERT_EQ(frame.report.match->place, place + 1000);
      ++counted;
    }
  }
}

// Frames that nothing is seen of where the robot stands become places once it has gone on.
TEST(SourceNumbers, OfPlacesThatWereHeldBack) {
  constexpr std::size_t size = 16;
  MatcherConfig closing = config(0);
  closing.use = Use::close_loops;
  const auto drive = oracle::drive(1, 60, size);
  PlaceMap map(closing, {100, size});
  Detector detector(closing, map);
  SourceNumbers numbers(closing, &map);
  std::uint64_t counted = 0;
  const auto take = [&](std::span<const float> descriptor) {
    static_cast<void>(detector.step(descriptor));
    ProcessedFrame frame = processed(counted + 1000, counted);
    numbers.rename(frame);
    ++counted;
  };
  for (std::size_t frame = 0; frame < drive.size(); ++frame) {
    take(drive[frame]);
    if (frame % 20 != 10) continue;
    take(drive[frame]);
    for (std::size_t i = 0; i < 2 * closing.sequence_length; ++i) take({});
  }
  EXPECT_EQ(map.size(), drive.size() + 3 * 2 * closing.sequence_length);
  ProcessedFrame frame = processed(counted + 1000, counted);
  for (std::size_t row = 0; row < map.size(); ++row) {
    const std::uint64_t number = map.order().number(row);
    frame.report.match = Match{.place = number, .head = number};
    numbers.rename(frame);
    EXPECT_EQ(frame.report.match->place, number + 1000) << row;
  }
}

TEST(SourceNumbers, LeaveAnotherDrivesPlacesAlone) {
  SourceNumbers numbers(config(), nullptr);
  ProcessedFrame frame = processed(90, 0);
  frame.report.match = Match{.place = 1234, .head = 1236};
  frame.report.now = Belief{.place = 77};
  numbers.rename(frame);
  EXPECT_EQ(frame.report.match->place, 1234U);
  EXPECT_EQ(frame.report.now->place, 77U);
}

TEST(SourceNumbers, AnEventIsNoFrame) {
  const PlaceMap map = map_of(10, 1);
  SourceNumbers numbers(config(), &map);
  ProcessedFrame nothing;
  nothing.report.gate = Gate::no_frame;
  numbers.rename(nothing);
  ProcessedFrame frame = processed(0, 0);
  numbers.rename(frame);
  EXPECT_EQ(frame.report.newest, 0U);
}

}  // namespace
}  // namespace seqloop::program
