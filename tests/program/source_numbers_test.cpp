// SPDX-License-Identifier: MIT
#include "program/run/source_numbers.hpp"

#include <gtest/gtest.h>

namespace seqloop::program {
namespace {

ProcessedFrame processed(std::uint64_t index, std::uint64_t counted) {
  ProcessedFrame frame;
  frame.frame.index = index;
  frame.report.gate = Gate::match;
  frame.report.newest = counted;
  if (counted >= 2) frame.report.frame = counted - 2;
  return frame;
}

TEST(SourceNumbers, AreTheDetectorsOwnWhereNothingIsMissing) {
  SourceNumbers numbers(5, 100);
  for (std::size_t i = 0; i < 50; ++i) {
    ProcessedFrame frame = processed(i, i);
    if (i >= 10) frame.report.match = Match{.place = i - 10, .head = i - 8};
    numbers.rename(frame);
    EXPECT_EQ(frame.report.newest, i);
    if (i < 10) continue;
    EXPECT_EQ(frame.report.frame, i - 2);
    EXPECT_EQ(frame.report.match->place, i - 10);
    EXPECT_EQ(frame.report.match->head, i - 8);
  }
}

TEST(SourceNumbers, CountShortGapsAndLongOnes) {
  SourceNumbers numbers(5, 100);
  ProcessedFrame first = processed(7, 0);  // a live source that was late
  numbers.rename(first);
  EXPECT_EQ(first.report.newest, 7U);
  ProcessedFrame second = processed(10, 3);  // 8 and 9 never came; the detector counted them
  numbers.rename(second);
  EXPECT_EQ(second.report.newest, 10U);
  EXPECT_EQ(second.report.frame, 8U);
  ProcessedFrame third = processed(500, 4);  // the detector left the gap out
  third.report.match = Match{.place = 1, .head = 3};
  numbers.rename(third);
  EXPECT_EQ(third.report.newest, 500U);
  EXPECT_EQ(third.report.frame, 9U);
  EXPECT_EQ(third.report.match->place, 8U);
  EXPECT_EQ(third.report.match->head, 10U);
}

TEST(SourceNumbers, LeaveAnotherDrivesPlacesAlone) {
  SourceNumbers numbers(5, 0);
  ProcessedFrame frame = processed(90, 0);
  frame.report.match = Match{.place = 1234, .head = 1236};
  numbers.rename(frame);
  EXPECT_EQ(frame.report.match->place, 1234U);
}

TEST(SourceNumbers, AnEventIsNoFrame) {
  SourceNumbers numbers(5, 10);
  ProcessedFrame nothing;
  nothing.report.gate = Gate::no_frame;
  numbers.rename(nothing);
  ProcessedFrame frame = processed(0, 0);
  numbers.rename(frame);
  EXPECT_EQ(frame.report.newest, 0U);
}

}  // namespace
}  // namespace seqloop::program
