// SPDX-License-Identifier: MIT
// Which sessions a map can do without.
#include "program/map/superseded.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace seqloop::program {
namespace {

using Places = std::vector<Sighting>;
using Sessions = std::vector<Places>;
using Indices = std::vector<std::size_t>;

/// Places that are visits of these numbers on.
Places lap(std::uint64_t first, std::size_t places) {
  Places all(places);
  for (std::size_t i = 0; i < places; ++i) all[i].first = first + i;
  return all;
}

TEST(Superseded, AreSessionsThatSixLaterOnesHaveSeen) {
  Sessions sessions(6, lap(0, 300));
  EXPECT_EQ(superseded(sessions), Indices{});
  sessions.push_back(lap(0, 300));
  EXPECT_EQ(superseded(sessions), Indices{0});
  sessions.push_back(lap(5'000, 300));
  EXPECT_EQ(superseded(sessions), Indices{0}) << "what is elsewhere supersedes nothing";
  sessions.push_back(lap(7, 300));
  EXPECT_EQ(superseded(sessions), (Indices{0, 1})) << "nearly the same place is the same";
  EXPECT_EQ(superseded({}), Indices{});
  EXPECT_EQ(superseded(Sessions(9)), Indices{}) << "those without places are none";
}

TEST(Superseded, ASessionStaysWhileAStretchOfItWasSeenNowhereElse) {
  Sessions sessions(7, lap(0, 1'000));
  Places& oldest = sessions.front();
  for (std::size_t i = 0; i < 15; ++i) oldest[400 + i].first = 9'000 + i;
  EXPECT_EQ(superseded(sessions), Indices{0});
  oldest[415].first = 9'015;
  EXPECT_EQ(superseded(sessions), Indices{}) << "16 places in a row";
}

TEST(Superseded, WhatLiesBesideWhatWasSeenAgainWasNot) {
  const auto but_for = [](std::size_t first, std::size_t places) {
    Places all = lap(0, 400);
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
    all.erase(begin, begin + static_cast<std::ptrdiff_t>(places));
    return all;
  };
  for (std::size_t first = 160; first < 176; ++first) {
    Sessions sessions(7, but_for(first, 16));
    sessions.front() = lap(0, 400);
    EXPECT_EQ(superseded(sessions), Indices{}) << "a side road that six drives have left out";
    sessions.assign(7, but_for(first, 15));
    sessions.front() = lap(0, 400);
    EXPECT_EQ(superseded(sessions), Indices{0}) << "one that is shorter";
  }
}

TEST(Superseded, WhatLiesBetweenPlacesThatWereSeenAgainWas) {
  // Drives at another pace see every third place, each another one.
  Sessions sessions{lap(0, 400)};
  for (std::uint64_t drive = 0; drive < 6; ++drive) {
    Places& some = sessions.emplace_back();
    for (std::uint64_t first = drive % 3; first < 403; first += 3) some.push_back({0, first});
  }
  EXPECT_EQ(superseded(sessions), Indices{0});
}

TEST(Superseded, ASessionStaysWhileTwoFifthsOfItWasSeenNowhereElse) {
  Sessions sessions(7, lap(0, 1'000));
  Places& oldest = sessions.front();
  for (std::size_t i = 0; i < 400; ++i) oldest[i / 10 * 25 + i % 10].first = 9'000 + i;
  EXPECT_EQ(superseded(sessions), Indices{0});
  oldest[990].first = 9'900;
  EXPECT_EQ(superseded(sessions), Indices{});
}

TEST(Successors, AreTheNewestPlacesOfTheSameSpotThatStay) {
  const Places goes{{100, 100, 1.0}, {101, 20, .8}, {102, 500, 1.0}};
  const Places stays{{300, 20, .99}, {310, 20, .7}, {305, 100, .6}};
  const std::vector<sqlite::Successor> found = successors(goes, stays);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].place, 100U);
  EXPECT_EQ(found[0].by, 305U);
  EXPECT_EQ(found[0].probability, .6) << "its link is the less sure one";
  EXPECT_EQ(found[1].by, 310U);
  EXPECT_EQ(found[1].probability, .7);
  EXPECT_EQ(found[2].place, 102U);
  EXPECT_EQ(found[2].by, 310U) << "as its neighbour's";
  EXPECT_TRUE(successors(goes, {}).empty());
}

TEST(Successors, AreThoseOfNeighboursUpToSixteenPlacesAway) {
  Places goes(100);
  for (std::size_t i = 0; i < goes.size(); ++i) goes[i] = {1'000 + i, 1'000 + i};
  const std::vector<sqlite::Successor> found = successors(goes, Places{{5'000, 1'040, .9}});
  ASSERT_EQ(found.size(), 33U);
  EXPECT_EQ(found.front().place, 1'024U);
  EXPECT_EQ(found.back().place, 1'056U);
  for (const sqlite::Successor& next : found) EXPECT_EQ(next.by, 5'000U);
}

}  // namespace
}  // namespace seqloop::program
