// SPDX-License-Identifier: MIT
#include "program/run/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "bags/bag_bytes.hpp"
#include "expect_setup_error.hpp"
#include "program/run/closure.hpp"
#include "program/run/frame_times.hpp"
#include "seqloop/bags/odometry.hpp"
#include "temporary_folder.hpp"

namespace seqloop::program {
namespace {

constexpr double pi = std::numbers::pi;

/// A turn about the axis that looks up.
Pose at(double x, double y, double yaw) {
  return {{x, y, 0.0}, {0.0, 0.0, std::sin(yaw / 2), std::cos(yaw / 2)}};
}

double yaw(const Pose& pose) { return 2.0 * std::atan2(pose.orientation[2], pose.orientation[3]); }

Answer loop(std::uint64_t frame, std::size_t place, float probability) {
  Answer answer;
  answer.frame = frame;
  answer.gate = Gate::match;
  answer.probability = probability;
  answer.match = Match{};
  answer.match->place = place;
  return answer;
}

TEST(Pose, MotionsLeadThere) {
  const Pose one = at(1.0, 2.0, pi / 2);
  const Pose step = motion(one, at(1.0, 5.0, pi));
  EXPECT_NEAR(step.position[0], 3.0, 1e-12) << "ahead";
  EXPECT_NEAR(step.position[1], 0.0, 1e-12);
  EXPECT_NEAR(yaw(step), pi / 2, 1e-12);
  const Pose there = compose(one, step);
  EXPECT_NEAR(there.position[1], 5.0, 1e-12);
  EXPECT_NEAR(std::abs(yaw(there)), pi, 1e-12);
  EXPECT_NEAR(metres(step), 3.0, 1e-12);
}

TEST(Pose, BetweenTurnsTheShorterWay) {
  Pose other = at(4.0, 0.0, 1.0);
  const Pose quarter = between(at(0.0, 0.0, 0.0), other, 0.25);
  EXPECT_NEAR(quarter.position[0], 1.0, 1e-12);
  EXPECT_NEAR(yaw(quarter), 0.25, 1e-12);
  for (double& value : other.orientation) value = -value;  // the same orientation
  EXPECT_NEAR(yaw(between(at(0.0, 0.0, 0.0), other, 0.25)), 0.25, 1e-12);
  EXPECT_NEAR(yaw(between(at(0.0, 0.0, 1.0), at(0.0, 0.0, 1.0 + 1e-9), 0.5)), 1.0, 1e-8);
}

TEST(Odometry, BetweenItsSamplesAndNowhereElse) {
  const Odometry odometry =
      parse_tum("# comment\n10 0 0 0 0 0 0 1\n\n 12\t4 0 0 0 0 0 2 \r\n", "o.tum", 10.0);
  EXPECT_FALSE(odometry.at(-0.1));
  EXPECT_EQ(odometry.at(0.0)->position[0], 0.0);
  EXPECT_NEAR(odometry.at(0.5)->position[0], 1.0, 1e-12);
  EXPECT_EQ(odometry.at(2.0)->position[0], 4.0);
  EXPECT_EQ(odometry.at(2.0)->orientation[3], 1.0) << "brought to unit length";
  EXPECT_FALSE(odometry.at(2.1));
}

TEST(Odometry, WhatIsNoneIsRefused) {
  const auto refusal = [](const std::string& text) {
    return test::setup_error([&] { static_cast<void>(parse_tum(text, "o.tum", 0.0)); });
  };
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_TRUE(test::says(refusal(""), "o.tum: holds fewer than two poses"));
  EXPECT_TRUE(test::says(refusal(good + "2 0 0 0 0 0 0\n"), "line 2 is no pose"));
  EXPECT_TRUE(test::says(refusal(good + "2 0 0 0 0 0 0 1 7\n"), "line 2 is no pose"));
  EXPECT_TRUE(test::says(refusal(good + "2 nan 0 0 0 0 0 1\n"), "line 2 is no pose"));
  EXPECT_TRUE(test::says(refusal(good + "2 0 0 0 0 0 0 0\n"), "line 2 is no pose"));
  EXPECT_TRUE(test::says(refusal(good + good), "line 2 is not later than the one before"));
  const std::string several = refusal(good + "x\n" + good + "2 0 0 0 0 0 0 0\n");
  for (const char* what : {"line 2 is no pose", "line 3 is not later", "line 4 is no pose"}) {
    EXPECT_TRUE(test::says(several, what));
  }
}

TEST(Odometry, FromABag) {
  const test::TemporaryFolder folder;
  test::McapBytes bag;
  bag.start().schema(1, "nav_msgs/msg/Odometry").channel(1, 1, "/odom").channel(2, 1, "/other");
  constexpr std::int64_t start = 1'700'000'000'000'000'000;
  for (int i = 0; i < 3; ++i) {
    test::Cdr message(i != 1);  // either byte order
    message.header(start + i * std::int64_t{1'000'000'000}, "odom").text("base_link");
    for (const double value : {1.0 + i, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}) message.put(value);
    bag.message(1, static_cast<std::uint64_t>(start), message.bytes());
  }
  bag.message(1, 5, test::Cdr().put(7).bytes()).finish();  // cut off
  const auto file = folder.write("b.mcap", std::string(bag.bytes.begin(), bag.bytes.end()));
  const auto poses = bags::read_odometry(file, "/odom");
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[1].stamp_ns, start + 1'000'000'000);
  EXPECT_EQ(poses[1].position, (std::array{2.0, 2.0, 3.0}));
  EXPECT_EQ(poses[1].orientation, (std::array{0.0, 0.0, 0.0, 1.0}));
  const Odometry odometry = read_odometry("/odom", file, start);
  EXPECT_NEAR(odometry.at(0.5)->position[0], 1.5, 1e-12);
  EXPECT_TRUE(
      test::says(test::setup_error([&] { static_cast<void>(bags::read_odometry(file, "/o")); }),
                 "has no topic /o of nav_msgs/msg/Odometry; there is /odom, /other"));
}

/// A robot that drives a metre a second, with odometry ten times a second.
std::vector<ros::OdometryPose> driven(std::int64_t start_ns, int poses) {
  std::vector<ros::OdometryPose> all;
  for (int i = 0; i < poses; ++i) {
    all.push_back({start_ns + i * std::int64_t{100'000'000}, {0.1 * i, 0.0, 0.0}, {0, 0, 0, 1}});
  }
  return all;
}

constexpr std::int64_t hour = 3'600'000'000'000;
constexpr std::int64_t began = 1'700'000'000'000'000'000;

TEST(Odometry, AnOddStampCostsOnePose) {
  for (const std::int64_t odd :
       {hour, -hour, std::int64_t{50'000'000}, -std::int64_t{150'000'000}}) {
    SCOPED_TRACE(odd);
    for (const SetBack clock : {SetBack::left_out, SetBack::begins_anew}) {
      auto poses = driven(began, 100);
      poses[40].stamp_ns += odd;
      const Odometry odometry = odometry_of(poses, "/odom", began, clock);
      for (const double time_s : {1.0, 3.95, 4.05, 9.9}) {
        ASSERT_TRUE(odometry.at(time_s)) << time_s;
        EXPECT_NEAR(odometry.at(time_s)->position[0], time_s, 0.1) << time_s;
      }
      EXPECT_LE(odometry.left_out(), 1U);
    }
  }
}

TEST(Odometry, AClockThatIsSetBack) {
  auto poses = driven(began, 50);
  for (ros::OdometryPose& pose : driven(began - hour, 100)) {
    pose.position[1] = 7.0;
    poses.push_back(pose);
  }
  const Odometry live = odometry_of(poses, "/odom", began - hour, SetBack::begins_anew);
  EXPECT_EQ(live.left_out(), 50U);
  ASSERT_TRUE(live.at(9.0));
  EXPECT_EQ(live.at(9.0)->position[1], 7.0);
  EXPECT_FALSE(live.at(3600.0 + 1.0)) << "of another time";
  const Odometry recorded = odometry_of(poses, "/odom", began, SetBack::left_out);
  EXPECT_EQ(recorded.left_out(), 100U);
  EXPECT_EQ(recorded.at(4.0)->position[1], 0.0)
      << "the times of a recording's frames do not go back";
}

TEST(Odometry, NothingIsKnownOfALongGap) {
  auto poses = driven(began, 300);
  poses.erase(poses.begin() + 100, poses.begin() + 210);
  const Odometry odometry = odometry_of(poses, "/odom", began, SetBack::left_out);
  EXPECT_TRUE(odometry.at(9.9));
  EXPECT_FALSE(odometry.at(10.0));
  EXPECT_FALSE(odometry.at(20.9));
  EXPECT_TRUE(odometry.at(21.0));
}

TEST(PoseGraph, WhatOfTheOdometryIsMissingIsTold) {
  const test::TemporaryFolder folder;
  PoseGraph graph(folder.path() / "g.g2o", {});
  auto poses = driven(began, 300);
  poses.erase(poses.begin() + 100, poses.begin() + 210);
  poses[20].stamp_ns += hour;
  graph.begin(odometry_of(poses, "/odom", began, SetBack::left_out), 0.0, 4);
  for (std::uint64_t frame = 0; frame < 31; ++frame) graph.add(frame, static_cast<double>(frame));
  EXPECT_EQ(
      graph.notes(),
      (std::vector<std::string>{
          "pose graph: 19 poses, 0 loops", "no pose: 1 frame outside of the odometry's times",
          "no pose: 11 frames between two poses of the odometry that are more than 10 s apart",
          "left out of the odometry: 1 pose that is none, or whose stamp does not rise"}));
}

TEST(Odometry, TimesOfAnotherClockAreRefused) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("o.tum", "1700000000 0 0 0 0 0 0 1\n1700000001 0 0 0 0 0 0 1\n");
  EXPECT_TRUE(test::says(
      test::setup_error([&] { static_cast<void>(read_odometry(file.string(), "drive", 0)); }),
      "its times must be those of the drive"));
  EXPECT_NO_THROW(static_cast<void>(
      read_odometry(file.string(), "drive", std::int64_t{1'700'000'000'000'000'000})));
}

TEST(PoseGraph, VerticesOdometryAndLoops) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "g.g2o";
  const auto trajectory = folder.path() / "t.tum";
  PoseGraph graph(file, trajectory);
  // Two metres a second along x; a frame a second, from before the odometry begins.
  graph.begin(parse_tum("1 0 0 0 0 0 0 -1\n11 20 0 0 0 0 0 -1\n", "o.tum", 0.0), 100.0, 4);
  for (std::uint64_t frame = 0; frame < 10; ++frame) graph.add(frame, static_cast<double>(frame));
  Answer unsure = loop(8, 1, 0.5F);
  unsure.gate = Gate::unsure;
  const std::vector answers{loop(9, 2, 1.0F), loop(5, 0, 1.0F), unsure, loop(8, 3, 0.5F)};
  graph.add(answers);
  EXPECT_EQ(graph.notes(),
            (std::vector<std::string>{"pose graph: 9 poses, 2 loops",
                                      "1 loop is left out of it for lack of a pose",
                                      "no pose: 1 frame outside of the odometry's times"}));
  Attempts attempts;
  graph.commit(attempts);
  attempts.end();
  std::istringstream lines(test::read_all(file));
  std::vector<std::string> vertices;
  std::vector<std::string> loops;
  int steps = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("VERTEX")) vertices.push_back(line);
    if (!line.starts_with("EDGE")) continue;
    if (line.find("SE3:QUAT 3 8 ") != std::string::npos ||
        line.find("SE3:QUAT 2 9 ") != std::string::npos)
      loops.push_back(line);
    else
      ++steps;
  }
  ASSERT_EQ(vertices.size(), 9U);
  EXPECT_EQ(vertices[1], "VERTEX_SE3:QUAT 2 2 0 0 0 0 0 1");
  EXPECT_EQ(steps, 8);
  ASSERT_EQ(loops.size(), 2U);
  // Two frames are four metres; four frames of a window count as one.
  const std::string turn = std::to_string(1.0 / 4.0 / std::pow(5.0 * pi / 180.0, 2)).substr(0, 6);
  EXPECT_TRUE(loops[0].starts_with("EDGE_SE3:QUAT 2 9 0 0 0 0 0 0 1 0.015625 0 0 0 0 0 0.015625 "))
      << loops[0];
  EXPECT_TRUE(test::says(loops[0], " 0 0 0.015625 0 0 0 " + turn));
  EXPECT_TRUE(
      loops[1].starts_with("EDGE_SE3:QUAT 3 8 0 0 0 0 0 0 1 0.0078125 0 0 0 0 0 0.0078125 "))
      << "half as probable: " << loops[1];
  EXPECT_TRUE(test::says(test::read_all(trajectory), "\n102.000000000 2 0 0 0 0 0 1\n"));
}

// Frames 3 to 8 never came. The drive's first place has the number 100.
TEST(LoopClosures, SayWhenTheirPlaceWasSeen) {
  FrameTimes times;
  for (const std::uint64_t frame : {0U, 1U, 2U, 9U, 10U}) {
    times.add({frame, 0.5 * static_cast<double>(frame), 100 + frame});
  }
  const StampAt stamp = [](double time_s) { return static_cast<std::int64_t>(1000.0 * time_s); };
  const auto seen = [&](std::uint64_t place) {
    return closure_of(loop(10, place, 1.0F), times, stamp, "today").match_stamp_ns;
  };
  EXPECT_EQ(closure_of(loop(10, 101, 1.0F), times, stamp, "today").stamp_ns, 5000);
  EXPECT_EQ(seen(101), 500);
  EXPECT_EQ(seen(109), 4500);
  EXPECT_EQ(seen(104), 0) << "it never came";
  EXPECT_EQ(seen(99), 0) << "of another session";
  EXPECT_EQ(seen(10), 0) << "likewise, though the drive has such a frame";

  const auto nearest = [&](std::uint64_t place) {
    const FrameTimes::Entry* const entry = times.nearest(place);
    return entry == nullptr ? -1 : static_cast<int>(entry->frame);
  };
  EXPECT_EQ(nearest(102), 2);
  EXPECT_EQ(nearest(104), 2);
  EXPECT_EQ(nearest(107), 9);
  EXPECT_EQ(nearest(99), -1);
  EXPECT_EQ(nearest(111), -1);
  FrameTimes localising;
  localising.add({0, 0.0, std::nullopt});
  EXPECT_EQ(localising.nearest(0), nullptr) << "places are another drive's";
}

TEST(PoseGraph, WithoutAnyPoseNothingIsWritten) {
  const test::TemporaryFolder folder;
  {
    PoseGraph graph(folder.path() / "g.g2o", {});
    graph.begin(parse_tum("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n", "o.tum", 0.0), 0.0, 4);
    graph.add(0, 5.0);
    Attempts attempts;
    graph.commit(attempts);
    EXPECT_TRUE(test::says(test::setup_error([&] { attempts.end(); }), "no frame of the drive"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace seqloop::program
