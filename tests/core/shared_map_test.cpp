// SPDX-License-Identifier: MIT
// Robots that localise in one map, each in a thread of its own: the thread sanitizer looks on.
#include <thread>

#include "core/matcher.hpp"
#include "core/ways.hpp"
#include "seqloop/visit_finder.hpp"

namespace seqloop {
namespace {

TEST(SharedMap, DetectorsLocaliseInItSideBySideAndAnswerAsAlone) {
  constexpr std::size_t frames = 150;
  const oracle::Vectors drive = test::way(1, frames, 0.3F, 1);
  const MatcherConfig config;
  PlaceMap map(config, {frames, drive.front().size()});
  VisitFinder visits(config, map, frames);
  for (const auto& place : drive) {
    ASSERT_TRUE(map.add(place));
    visits.take(place);
  }
  visits.link(map);
  const auto matches = [&map, &config](std::uint32_t visit) {
    std::vector<std::uint64_t> found;
    Detector detector(config, map);
    const auto note = [&found](std::span<const Answer> answers) {
      for (const Answer& answer : answers) {
        if (answer.gate == Gate::match) found.push_back(answer.match->place);
      }
    };
    for (const auto& frame : test::way(1, frames, 0.3F, visit)) note(detector.step(frame).answers);
    note(detector.finish());
    return found;
  };
  std::vector<std::uint64_t> first;
  std::vector<std::uint64_t> second;
  std::thread other([&] { first = matches(2); });
  second = matches(3);
  other.join();
  EXPECT_GT(first.size(), frames / 2);
  EXPECT_GT(second.size(), frames / 2);
  EXPECT_EQ(first, matches(2));
  EXPECT_EQ(second, matches(3));
}

}  // namespace
}  // namespace seqloop
