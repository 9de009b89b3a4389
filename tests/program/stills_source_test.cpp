// SPDX-License-Identifier: MIT
// Which frames become stills and what is cut out of them, on drives in memory.
#include "program/drives/stills_source.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "expect_setup_error.hpp"
#include "program/drives/stills_options.hpp"
#include "synthetic_drive.hpp"

namespace seqloop::program {
namespace {

constexpr double fps = 10.0;

std::vector<cv::Mat> pictures(std::size_t count, int width = 8, int height = 6) {
  std::vector<cv::Mat> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(test::textured(width, height, i + 1));
  return all;
}

/// The source's frames that become stills, told by their times.
std::vector<long> taken(const StillsSettings& settings, std::size_t frames, double rate = fps) {
  const auto stills =
      make_stills(std::make_unique<test::SyntheticDrive>(pictures(frames), rate), settings);
  std::vector<long> found;
  Frame frame;
  while (stills->grab(frame) != Grab::end) {
    EXPECT_EQ(frame.index, found.size());
    found.push_back(std::lround(frame.time_s * rate));
  }
  EXPECT_EQ(stills->grab(frame), Grab::end) << "and stays there";
  EXPECT_EQ(frame.index, found.size());
  return found;
}

TEST(StillsSource, WithoutSettingsIsTheDriveItself) {
  std::vector<cv::Mat> all = pictures(5);
  all[2] = cv::Mat();
  test::SyntheticDrive drive(all);
  const auto stills = make_stills(std::make_unique<test::SyntheticDrive>(all), {});
  EXPECT_EQ(stills->frame_count(), 5U);
  EXPECT_EQ(stills->notes(), drive.notes());
  Frame wanted;
  Frame frame;
  Grab grab = Grab::frame;
  while (grab != Grab::end) {
    grab = drive.grab(wanted);
    EXPECT_EQ(stills->grab(frame), grab);
    EXPECT_EQ(frame.index, wanted.index);
    EXPECT_EQ(frame.fault, wanted.fault);
    EXPECT_EQ(frame.image.data, wanted.image.data) << "not even copied";
    EXPECT_EQ(frame.image.stride, wanted.image.stride);
    if (grab != Grab::end) {
      EXPECT_EQ(frame.time_s, wanted.time_s);
    }
  }
}

TEST(StillsSource, TakesTheFirstFrameAtOrAfterEachMultiple) {
  EXPECT_EQ(taken({.every_s = 1.0}, 31), (std::vector<long>{0, 10, 20, 30}));
  EXPECT_EQ(taken({.every_s = 0.25}, 11), (std::vector<long>{0, 3, 5, 8, 10}));
  EXPECT_EQ(taken({.every_s = 0.04}, 4), (std::vector<long>{0, 1, 2, 3})) << "none comes twice";
  // Divided as they are, 0.3 and 0.6 fall short of multiples of 0.1.
  EXPECT_EQ(taken({.every_s = 0.1}, 8), (std::vector<long>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(StillsSource, KeepsToTheNinetyMinutesOfThePaper) {
  const auto all = taken({.every_s = 1.0, .to_s = 5400.0}, 12'000, 2.0);
  ASSERT_EQ(all.size(), 5400U);
  EXPECT_EQ(all.back(), 2L * 5399);
}

TEST(StillsSource, BeginsAndEndsAndLeavesOutByTheSourcesClock) {
  EXPECT_EQ(taken({.from_s = 0.3, .to_s = 0.6}, 10), (std::vector<long>{3, 4, 5}));
  EXPECT_EQ(taken({.every_s = 1.0, .from_s = 0.5}, 25), (std::vector<long>{10, 20}))
      << "multiples count from 0";
  EXPECT_EQ(taken({.leave_out = {{0.7, 5.0}, {0.0, 0.2}, {0.1, 0.4}}}, 10),
            (std::vector<long>{4, 5, 6}));
  EXPECT_EQ(taken({.every_s = 0.5, .leave_out = {{0.9, 1.2}}}, 21),
            (std::vector<long>{0, 5, 15, 20}))
      << "what is left out moves no later still";
  EXPECT_EQ(taken({.from_s = 3.0}, 10), std::vector<long>{});
}

TEST(StillsSource, KnowsItsLengthOnlyWhereEveryFrameIsTaken) {
  const auto length = [](const StillsSettings& settings) {
    return make_stills(std::make_unique<test::SyntheticDrive>(pictures(5)), settings)
        ->frame_count();
  };
  EXPECT_EQ(length({.width = 4, .height = 3, .gray = true}), 5U);
  for (const StillsSettings& settings :
       {StillsSettings{.every_s = 1.0}, {.from_s = 1.0}, {.to_s = 1.0}, {.leave_out = {{0, 1}}}}) {
    EXPECT_EQ(length(settings), std::nullopt);
  }
}

TEST(StillsSource, CutsOutWithoutCopying) {
  for (const int type : {CV_8UC3, CV_8UC1}) {
    const cv::Mat picture = test::textured(20, 12, 3, type);
    const Crop crop{7, 5, 13, 7};  // touches the right and the lower edge
    const auto stills = make_stills(
        std::make_unique<test::SyntheticDrive>(std::vector<cv::Mat>{picture}), {.crop = crop});
    Frame frame;
    ASSERT_EQ(stills->grab(frame), Grab::frame);
    EXPECT_EQ(frame.index, 0U) << "looked at before, handed over once";
    EXPECT_EQ(frame.image.data, picture.ptr(7, 13));
    EXPECT_EQ(frame.image.width, 7);
    EXPECT_EQ(frame.image.height, 5);
    EXPECT_EQ(frame.image.stride, picture.step[0]);
    EXPECT_EQ(stills->grab(frame), Grab::end);
  }
}

TEST(StillsSource, ResizesBeforeItCutsOut) {
  cv::Mat picture(4, 8, CV_8UC3, cv::Scalar::all(10));
  picture(cv::Rect(4, 0, 4, 4)) = cv::Scalar(30, 60, 90);
  const auto stills =
      make_stills(std::make_unique<test::SyntheticDrive>(std::vector<cv::Mat>{picture}),
                  {.width = 4, .height = 2, .crop = {2, 1, 1, 1}, .gray = true});
  Frame frame;
  ASSERT_EQ(stills->grab(frame), Grab::frame);
  ASSERT_EQ(frame.image.format, PixelFormat::gray8);
  ASSERT_EQ(frame.image.width, 2);
  ASSERT_EQ(frame.image.height, 1);
  EXPECT_EQ(frame.image.data[0], 10);
  EXPECT_EQ(frame.image.data[1], 66) << "0.114 * 30 + 0.587 * 60 + 0.299 * 90 = 65.6";
}

TEST(StillsSource, FramesThatCannotBeReadStayInStep) {
  std::vector<cv::Mat> all = pictures(4, 20, 12);
  all[1] = cv::Mat();
  all[2] = test::textured(10, 6);  // too small for the crop
  const auto stills =
      make_stills(std::make_unique<test::SyntheticDrive>(all), {.crop = {12, 8, 4, 2}});
  Frame frame;
  EXPECT_EQ(stills->grab(frame), Grab::frame);
  EXPECT_EQ(stills->grab(frame), Grab::unreadable);
  EXPECT_EQ(frame.fault, "torn");
  EXPECT_EQ(stills->grab(frame), Grab::unreadable);
  EXPECT_TRUE(test::says(std::string(frame.fault), "too small"));
  EXPECT_EQ(frame.image.data, nullptr);
  EXPECT_EQ(frame.index, 2U);
  EXPECT_EQ(stills->grab(frame), Grab::frame);
}

TEST(StillsSource, TellsEveryFaultAtOnce) {
  const std::string said = test::setup_error([] {
    (void)make_stills(std::make_unique<test::SyntheticDrive>(pictures(1)),
                      {.every_s = 1e-4,
                       .from_s = -1.0,
                       .to_s = -2.0,
                       .leave_out = {{2.0, 1.0}},
                       .width = 64,
                       .height = 32,
                       .crop = {48, 32, 17, 0}});
  });
  for (const char* word : {"every-s", "from-s", "to-s", "leave-out: 2 to 1", "48x32+17+0"}) {
    EXPECT_TRUE(test::says(said, word));
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(validate({.every_s = nan, .from_s = nan, .to_s = nan, .leave_out = {{0, nan}}}).size(),
            4U);
}

TEST(StillsSource, ACropOutsideOfTheFirstPictureIsAFault) {
  const std::string said = test::setup_error([] {
    (void)make_stills(std::make_unique<test::SyntheticDrive>(pictures(1, 20, 12)),
                      {.crop = {10, 10, 0, 3}});
  });
  EXPECT_TRUE(test::says(said, "10x10+0+3 does not lie in pictures of 20x12"));
}

TEST(StillsOptions, ReadIntervalsAndCrops) {
  const auto intervals = parse_intervals("90-120.5,1:02:10-1:03:00,0:05-1:00");
  ASSERT_EQ(intervals.size(), 3U);
  EXPECT_EQ(intervals[0].from_s, 90.0);
  EXPECT_EQ(intervals[0].to_s, 120.5);
  EXPECT_EQ(intervals[1].from_s, 3730.0);
  EXPECT_EQ(intervals[1].to_s, 3780.0);
  EXPECT_EQ(intervals[2].from_s, 5.0);
  for (const char* text : {"", "5", "5-", "-5", "5-6,", "1-2-3", "1:60-2:00", "1:2:3:4-9", "a-b",
                           "1:-5-2", "none.csv"}) {
    EXPECT_THROW((void)parse_intervals(text), std::invalid_argument) << text;
  }
  const Crop crop = parse_crop("480x320+100+7");
  EXPECT_EQ(crop.width, 480);
  EXPECT_EQ(crop.height, 320);
  EXPECT_EQ(crop.x, 100);
  EXPECT_EQ(crop.y, 7);
  EXPECT_EQ(parse_crop("48x32").x, 0);
  for (const char* text : {"", "480", "480x", "0x3+0+0", "4x3+1", "4x3+1+2+3", "4x3+-1+0", "4x3x2",
                           "4.5x3", "99999x1", "x", "4x3 +1+2"}) {
    EXPECT_THROW((void)parse_crop(text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace seqloop::program
