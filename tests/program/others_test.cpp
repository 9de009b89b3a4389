// SPDX-License-Identifier: MIT
// What is taken in of what others say; anybody may say anything.
#include "program/fleet/others.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "program/fleet/place_queue.hpp"

namespace seqloop::program {
namespace {

constexpr std::int64_t second = 1'000'000'000;

dds::FleetSession about(const std::string& robot = "b", const std::string& name = "today") {
  return {robot, name, "int8 euclidean standardised", "gradients", 4, 4};
}

/// Says places as a robot does, ten a second.
class OthersTest : public ::testing::Test {
 protected:
  std::optional<std::uint32_t> hear(std::int64_t session, std::uint64_t frame,
                                    const dds::FleetSession* what = nullptr) {
    return hear_at(session, frame, static_cast<std::int64_t>(frame) * second / 10, what);
  }
  std::optional<std::uint32_t> hear_at(std::int64_t session, std::uint64_t frame,
                                       std::int64_t time_ns,
                                       const dds::FleetSession* what = nullptr) {
    return others_.hear({session, frame, time_ns, bytes_, {}, {}}, what);
  }
  std::optional<std::uint32_t> hear_statistics(std::int64_t session,
                                               const std::vector<double>& mean,
                                               const std::vector<double>& variance,
                                               std::uint64_t frames = 9) {
    dds::FleetPlace place{.session = session};
    place.statistics = {frames, mean, variance};
    return others_.statistics(place);
  }

  const dds::FleetSession about_ = about();
  const std::array<std::byte, 4> bytes_{};
  Others others_{about("a"), {77, 5}, 100};
};

TEST_F(OthersTest, SessionsAreCountedAsTheyAreFirstHeard) {
  const dds::FleetSession other = about("c", "yesterday");
  EXPECT_EQ(hear(1000, 0), std::nullopt) << "nothing is known of it yet";
  EXPECT_EQ(hear(1000, 1, &about_), 0U);
  EXPECT_EQ(hear(2000, 7, &other), 1U);
  EXPECT_EQ(hear(1000, 2), 0U);
  EXPECT_EQ(others_.names(1).robot, "c");
  EXPECT_EQ(others_.names(1).session, "yesterday");
  EXPECT_EQ(others_.places(), 3U);
  EXPECT_TRUE(others_.news().empty());
}

TEST_F(OthersTest, NothingIsCountedTwice) {
  for (std::uint64_t frame = 0; frame < 10; ++frame) EXPECT_TRUE(hear(1000, frame, &about_));
  // A restart, a healed partition, or another who has it; under another name.
  const dds::FleetSession renamed = about("b2");
  for (std::uint64_t frame = 0; frame < 10; ++frame) EXPECT_FALSE(hear(1000, frame, &renamed));
  EXPECT_EQ(hear(1000, 10, &renamed), 0U) << "and goes on";
  // Our own come back.
  EXPECT_FALSE(hear(77, 0, &about_));
  EXPECT_FALSE(hear(5, 0, &about_));
  EXPECT_EQ(others_.places(), 11U);
  EXPECT_TRUE(others_.news().empty());
}

TEST_F(OthersTest, WhatIsNoDescriptorIsNoPlace) {
  EXPECT_EQ(hear(1000, 0, &about_), 0U);
  const std::array<std::byte, 4> lowest{std::byte{1}, std::byte{0x80}, std::byte{2}, std::byte{3}};
  EXPECT_FALSE(others_.hear({1000, 1, second, lowest, {}, {}}, &about_));
  EXPECT_EQ(others_.news().at(0),
            "robot 'b', session 'today': it sends values that are no numbers: no more of it is "
            "taken in");
  EXPECT_FALSE(hear(1000, 2));
  const dds::FleetSession floats{"b", "today", "float euclidean raw", "gradients", 2, 8};
  Others others({"a", "x", "float euclidean raw", "gradients", 2, 8}, {}, 100);
  const auto hear_floats = [&](std::int64_t session, std::array<float, 2> values) {
    const auto bytes = std::as_bytes(std::span(values));
    return others.hear({session, 0, 0, bytes, {}, {}}, &floats);
  };
  constexpr float most = std::numeric_limits<float>::max();
  EXPECT_TRUE(hear_floats(1, {-most, std::numeric_limits<float>::denorm_min()}));
  EXPECT_FALSE(hear_floats(2, {0.5F, std::numeric_limits<float>::quiet_NaN()}));
  EXPECT_FALSE(hear_floats(3, {-std::numeric_limits<float>::infinity(), 0.5F}));
}

TEST_F(OthersTest, StatisticsAreThoseOfASessionThatIsHeard) {
  const std::vector<double> some{1.0, 0.0, -2.0, 3.0};
  const std::vector<double> squares{1.0, 0.0, 2.0, 3.0};
  EXPECT_EQ(hear_statistics(1000, some, squares), std::nullopt) << "nothing is known of it";
  EXPECT_EQ(hear(1000, 0, &about_), 0U);
  EXPECT_EQ(hear_statistics(1000, some, squares), 0U);
  EXPECT_TRUE(others_.news().empty());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::vector<double>, std::vector<double>>> nonsense{
      {{1.0, 2.0, 3.0}, squares},
      {some, {1.0}},
      {{nan, 0.0, 0.0, 0.0}, squares},
      {some, {0.0, nan, 0.0, 0.0}},
      {some, {0.0, 0.0, 0.0, -1.0}}};
  std::int64_t session = 2000;
  for (const auto& [mean, variance] : nonsense) {
    EXPECT_TRUE(hear(++session, 0, &about_));
    EXPECT_EQ(hear_statistics(session, mean, variance), std::nullopt);
    EXPECT_EQ(others_.news().size(), 1U);
    EXPECT_FALSE(hear(session, 1, &about_)) << "no more of it is taken in";
    EXPECT_EQ(hear_statistics(session, some, squares), std::nullopt);
  }
  EXPECT_TRUE(hear(3000, 0, &about_));
  EXPECT_EQ(hear_statistics(3000, some, squares, 0), std::nullopt) << "of no frames";
}

TEST_F(OthersTest, WhatCannotBeComparedIsRefusedByNameAndOnce) {
  dds::FleetSession model = about();
  model.describer = "model 0123";
  dds::FleetSession form = about("c");
  form.form = "sketch euclidean standardised";
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    EXPECT_FALSE(hear(1000, frame, &model));
    EXPECT_FALSE(hear(2000, frame, &form));
  }
  EXPECT_EQ(others_.news(),
            (std::vector<std::string>{
                "robot 'b', session 'today': its places are int8 euclidean standardised, of 4 "
                "values, described by 'model 0123'; these are int8 euclidean standardised, of 4 "
                "values, described by 'gradients': none is taken in; describe and compare alike on "
                "both",
                "robot 'c', session 'today': its places are sketch euclidean standardised, of 4 "
                "values, described by 'gradients'; these are int8 euclidean standardised, of 4 "
                "values, described by 'gradients': none is taken in; describe and compare alike on "
                "both"}));
  EXPECT_EQ(others_.sessions(), 0U);
}

TEST_F(OthersTest, OneThatLiesAboutSizesIsNotHeardAnyMore) {
  EXPECT_TRUE(hear(1000, 0, &about_));
  const std::vector<std::byte> large(1 << 20);
  EXPECT_FALSE(others_.hear({1000, 1, second, large, {}}, nullptr));
  EXPECT_FALSE(hear(1000, 2));
  EXPECT_EQ(others_.news(),
            (std::vector<std::string>{"robot 'b', session 'today': it says 4 bytes a place, and "
                                      "sends 1048576: no more of it is taken in"}));
}

TEST_F(OthersTest, OneWhoseTimeGoesBackIsNotHeardAnyMore) {
  EXPECT_TRUE(hear_at(1000, 0, INT64_MIN, &about_));
  EXPECT_TRUE(hear_at(1000, 1, INT64_MAX));
  EXPECT_FALSE(hear_at(1000, 2, 0));
  EXPECT_FALSE(hear_at(1000, 3, INT64_MAX));
  EXPECT_EQ(others_.news(), (std::vector<std::string>{"robot 'b', session 'today': its time goes "
                                                      "back: no more of it is taken in"}));
}

TEST_F(OthersTest, AFloodIsBoundedByTheRoomAndByTheDrivesOwnTime) {
  Others others(about("a"), {}, 10'000);
  const dds::FleetSession what = about();
  std::size_t taken = 0;
  for (std::uint64_t frame = 0; frame < 9'000; ++frame) {
    taken += others.hear({1000, frame, 0, bytes_, {}}, &what).has_value();
  }
  EXPECT_EQ(taken, 2'000U) << "of a drive of no time";
  EXPECT_EQ(others.news(),
            (std::vector<std::string>{"robot 'b', session 'today': it has more than 1000 places a "
                                      "second of its drive: no more of it is taken in"}));
  for (std::uint64_t frame = 0; frame < 9'000; ++frame) {
    const auto time_ns = static_cast<std::int64_t>(frame) * second / 30;
    taken += others.hear({2000, frame, time_ns, bytes_, {}}, &what).has_value();
  }
  EXPECT_EQ(taken, 10'000U);
  EXPECT_EQ(others.news(),
            (std::vector<std::string>{"there is room for 10000 places of other robots, and more "
                                      "have come; raise --fleet-places"}));
}

TEST_F(OthersTest, VisitsAreOfPlacesThatWereTakenIn) {
  const dds::FleetSession other = about("c");
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    EXPECT_EQ(hear(1000, frame, &about_), 0U);
    EXPECT_EQ(hear(2000, frame, &other), 1U);
  }
  const auto same = [&](std::int64_t session, std::uint64_t frame, std::int64_t visited,
                        std::uint64_t then) {
    return others_.same_place({session, frame, 0, {}, {{visited, then}}});
  };
  ASSERT_TRUE(same(2000, 9, 1000, 9));
  EXPECT_EQ(same(2000, 9, 1000, 9)->session, 1U);
  EXPECT_EQ(same(2000, 9, 1000, 9)->visited, 0U);
  EXPECT_TRUE(same(1000, 5, 1000, 2));
  EXPECT_FALSE(same(1000, 10, 1000, 2));
  EXPECT_FALSE(same(1000, 5, 1000, 10));
  EXPECT_FALSE(same(3000, 0, 1000, 0));
  EXPECT_FALSE(same(1000, 0, 77, 0)) << "ours";
}

TEST_F(OthersTest, VisitsWaitForPlacesThatAreStillOnTheirWay) {
  const auto visit = [](std::int64_t session, std::uint64_t frame, std::int64_t visited,
                        std::uint64_t then) {
    return dds::FleetPlace{session, frame, 0, {}, {{visited, then}}, {}};
  };
  EXPECT_EQ(hear(1000, 0, &about_), 0U);
  others_.wait_for_places(visit(1000, 0, 2000, 3));
  others_.wait_for_places(visit(1000, 2, 2000, 1));
  others_.wait_for_places(visit(1000, 0, 2000, 2));
  others_.wait_for_places(visit(1000, 0, 77, 2));  // ours: it never comes
  EXPECT_FALSE(others_.next_visit());
  EXPECT_EQ(hear(2000, 2, &about_), 1U);
  auto come = others_.next_visit();
  ASSERT_TRUE(come);
  EXPECT_EQ(come->session, 1000);
  EXPECT_EQ(come->frame, 0U);
  EXPECT_EQ(come->visit->session, 2000);
  EXPECT_EQ(come->visit->frame, 2U);
  EXPECT_FALSE(others_.next_visit());
  EXPECT_EQ(hear(1000, 2), 0U);
  EXPECT_EQ(hear(2000, 3), 1U);
  come = others_.next_visit();
  ASSERT_TRUE(come) << "those that came early first";
  EXPECT_EQ(come->visit->frame, 3U);
  come = others_.next_visit();
  ASSERT_TRUE(come);
  EXPECT_EQ(come->frame, 2U);
  EXPECT_FALSE(others_.next_visit());
}

TEST_F(OthersTest, VisitsOfWhatNeverComesAreBounded) {
  EXPECT_EQ(hear(1000, 0, &about_), 0U);
  for (std::uint64_t frame = 0; frame < 5'000; ++frame) {
    others_.wait_for_places({1000, 0, 0, {}, {{2000, frame}}, {}});
    EXPECT_FALSE(others_.next_visit());
  }
  EXPECT_EQ(hear(2000, 10'000, &about_), 1U);
  for (std::uint64_t frame = 5'000 - 1024; frame < 5'000; ++frame) {
    const auto come = others_.next_visit();
    ASSERT_TRUE(come);
    ASSERT_EQ(come->visit->frame, frame) << "the newest are kept";
  }
  EXPECT_FALSE(others_.next_visit());
}

TEST_F(OthersTest, SessionsWithoutEndAreBounded) {
  for (std::int64_t session = 0; session < 5'000; ++session) {
    static_cast<void>(hear(1'000'000 + session, 0, &about_));
  }
  EXPECT_EQ(others_.places(), 100U);
  const std::vector<std::string> news = others_.news();
  ASSERT_EQ(news.size(), 2U);
  EXPECT_EQ(
      news[1],
      "other robots have more than 1024 sessions: what is beyond is not heard; let a keeper's "
      "map forget old ones (`seqloop map forget`)");
}

TEST_F(OthersTest, AKeeperWhoseMapHasMoreSessionsThanAreHeardHearsNoNewOnes) {
  for (std::int64_t session = 0; session < 1'100; ++session) {
    static_cast<void>(others_.resume({"b", "old", 1'000'000 + session}, {1, 0, 0, 0}));
  }
  EXPECT_FALSE(hear(1000, 0, &about_));
  ASSERT_EQ(others_.news().size(), 1U);
}

TEST_F(OthersTest, NamesAreFitToBePrinted) {
  const dds::FleetSession evil = about("\x1b[2J\xff" + std::string(100'000, 'x'), "");
  EXPECT_TRUE(hear(1000, 0, &evil));
  EXPECT_LT(others_.names(0).robot.size(), 200U);
  EXPECT_EQ(others_.names(0).robot.substr(0, 11), "\\x1B[2J\\xFF");
  EXPECT_EQ(others_.names(0).session, "without a name");
}

TEST(PlaceQueue, GivesBackWhatWasPutInInOrder) {
  PlaceQueue queue(3, 2);
  std::uint64_t next = 0;
  std::uint64_t taken = 0;
  for (int round = 0; round < 10; ++round) {
    while (!queue.full()) {
      const std::array<std::byte, 2> bytes{static_cast<std::byte>(next), std::byte{9}};
      queue.push({static_cast<std::uint32_t>(next % 5), next, bytes, {}});
      ++next;
    }
    for (int i = 0; i < 2; ++i, ++taken, queue.pop()) {
      const PlaceQueue::Place* const place = queue.front();
      ASSERT_NE(place, nullptr);
      EXPECT_EQ(place->frame, taken);
      EXPECT_EQ(place->session, taken % 5);
      EXPECT_EQ(place->bytes[0], static_cast<std::byte>(taken));
    }
  }
  queue.pop();
  EXPECT_EQ(queue.front(), nullptr);
}

}  // namespace
}  // namespace seqloop::program
