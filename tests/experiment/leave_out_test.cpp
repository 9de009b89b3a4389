// SPDX-License-Identifier: MIT
#include "experiment/run/leave_out.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "expect_setup_error.hpp"
#include "seqloop/files/descriptor_source.hpp"
#include "synthetic_drive.hpp"

namespace seqloop::experiment {
namespace {

using Frames = std::vector<std::uint64_t>;

/// Plain pictures of these grey levels; below 0: cannot be read.
std::vector<cv::Mat> plain(const std::vector<int>& levels, cv::Size size = {64, 32}) {
  std::vector<cv::Mat> pictures;
  for (const int level : levels) {
    pictures.push_back(level < 0 ? cv::Mat() : cv::Mat(size, CV_8UC3, cv::Scalar::all(level)));
  }
  return pictures;
}

KeptFrames kept(const std::vector<int>& reference, const std::vector<int>& query,
                const LeaveOutRule& rule = {.dark_below = 40.0, .standing_below = 5.0}) {
  test::SyntheticDrive one(plain(reference));
  test::SyntheticDrive other(plain(query, {640, 320}));
  return leave_out(one, other, rule);
}

TEST(LeaveOut, AFrameThatIsDarkInEitherDriveGoes) {
  const KeptFrames found = kept({100, 39, 120, 40, 80}, {100, 200, 10, 150, 70});
  EXPECT_EQ(found.frames, (Frames{0, 3, 4}));
  EXPECT_EQ(found.dark, 2U);
  EXPECT_EQ(found.standing, 0U);
}

TEST(LeaveOut, AFrameThatStandsInEitherDriveGoes) {
  const KeptFrames found = kept({100, 104, 120, 140, 160}, {100, 130, 160, 164, 190});
  EXPECT_EQ(found.frames, (Frames{0, 2, 4})) << "one goes by the reference, one by the query";
  EXPECT_EQ(found.standing, 2U);
}

TEST(LeaveOut, StandingIsMeasuredFromTheFrameKeptLast) {
  // Creeping on by 3: every second one differs enough. Dark frames in between count for nothing.
  EXPECT_EQ(kept({100, 103, 106, 109, 112}, {0, 50, 100, 150, 200}, {0.0, 5.0}).frames,
            (Frames{0, 2, 4}));
  EXPECT_EQ(kept({100, 10, 102, 150}, {100, 130, 160, 200}).frames, (Frames{0, 3}));
}

TEST(LeaveOut, ThresholdsAreBelowNotAt) {
  EXPECT_EQ(kept({40, 45, 50}, {40, 45, 50}).frames, (Frames{0, 1, 2}));
  EXPECT_EQ(kept({0, 0, 0}, {0, 0, 0}, {0.0, 0.0}).frames, (Frames{0, 1, 2}))
      << "both switched off";
}

TEST(LeaveOut, AFrameThatCannotBeReadStays) {
  const KeptFrames found = kept({100, -1, 101, -1, 180}, {100, -1, 160, 20, 200});
  EXPECT_EQ(found.frames, (Frames{0, 1, 4})) << "2 stands as 0 did, 3 is dark in the other drive";
  EXPECT_EQ(found.dark, 1U);
  EXPECT_EQ(found.standing, 1U);
}

TEST(LeaveOut, DifferencesAreMeansOverAllPixels) {
  // A quarter of the picture changes by 16: 4 on the whole. By 24: 6.
  const auto drive = [](int change) {
    std::vector<cv::Mat> pictures = plain({100, 100});
    pictures[1](cv::Rect(0, 0, 32, 16)) = cv::Scalar::all(100 + change);
    return pictures;
  };
  for (const auto& [change, frames] : {std::pair{16, 1U}, std::pair{-16, 1U}, std::pair{24, 2U}}) {
    test::SyntheticDrive one(drive(change));
    test::SyntheticDrive other(plain({60, 160}));
    EXPECT_EQ(leave_out(one, other, {}).frames.size(), frames) << change;
  }
}

TEST(LeaveOut, WhatItRefuses) {
  EXPECT_EQ(kept({}, {}).frames, Frames{});
  EXPECT_TRUE(test::says(test::setup_error([] { (void)kept({100, 200}, {100}); }), "frame 1"));
  EXPECT_TRUE(test::says(test::setup_error([] { (void)kept({}, {100}); }), "frame 0"));
  const std::string said = test::setup_error([] {
    (void)kept({1}, {1}, {-1.0, std::numeric_limits<double>::quiet_NaN()});
  });
  EXPECT_TRUE(test::says(said, "dark_below"));
  EXPECT_TRUE(test::says(said, "standing_below"));
  files::DescriptorSource described({.rows = 1, .columns = 2, .values = {1.0F, 0.0F}}, 10.0);
  test::SyntheticDrive pictures(plain({100}));
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)leave_out(pictures, described, {}); }),
                         "descriptors"));
}

}  // namespace
}  // namespace seqloop::experiment
