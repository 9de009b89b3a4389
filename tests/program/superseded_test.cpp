// SPDX-License-Identifier: MIT
// Which sessions a map can do without.
#include "program/map/superseded.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace seqloop::program {
namespace {

using Sessions = std::vector<std::vector<std::uint64_t>>;
using Indices = std::vector<std::size_t>;

/// Places that are visits of these numbers on.
std::vector<std::uint64_t> lap(std::uint64_t first, std::size_t places) {
  std::vector<std::uint64_t> all(places);
  for (std::size_t i = 0; i < places; ++i) all[i] = first + i;
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
  std::vector<std::uint64_t>& oldest = sessions.front();
  for (std::size_t i = 0; i < 60; ++i) oldest[400 + i] = 9'000 + i;
  EXPECT_EQ(superseded(sessions), Indices{0});
  oldest[460] = 9'060;
  EXPECT_EQ(superseded(sessions), Indices{}) << "61 places in a row";
}

TEST(Superseded, ASessionStaysWhileTwoFifthsOfItWasSeenNowhereElse) {
  Sessions sessions(7, lap(0, 1'000));
  std::vector<std::uint64_t>& oldest = sessions.front();
  for (std::size_t i = 0; i < 400; ++i) oldest[i / 50 * 125 + i % 50] = 9'000 + i;
  EXPECT_EQ(superseded(sessions), Indices{0});
  oldest[960] = 9'900;
  EXPECT_EQ(superseded(sessions), Indices{});
}

}  // namespace
}  // namespace seqloop::program
