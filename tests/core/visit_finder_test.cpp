// SPDX-License-Identifier: MIT
// Laps of a reference are one place, and a robot localises in them.
#include "seqloop/visit_finder.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "core/matcher.hpp"
#include "core/ways.hpp"
#include "expect_setup_error.hpp"

namespace seqloop {
namespace {

using oracle::Vectors;

constexpr std::size_t lap = 150;

Vectors laps(std::uint32_t count, std::uint32_t first_visit = 1) {
  Vectors drive;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vectors one = test::way(1, lap, 0.3F, first_visit + i);
    drive.insert(drive.end(), one.begin(), one.end());
  }
  return drive;
}

/// A map of a drive. @param places that are looked through; none: of all of them
PlaceMap map_of(const Vectors& drive, const MatcherConfig& config, std::size_t places) {
  PlaceMap map(config, {drive.size(), drive.front().size()});
  std::optional<VisitFinder> visits;
  if (places > 0) visits.emplace(config, map, places);
  for (const auto& place : drive) static_cast<void>(map.learn(place));
  for (const auto& place : drive) {
    EXPECT_TRUE(map.add(place));
    if (visits) visits->take(place);
  }
  if (visits) visits->link(map);
  return map;
}

/// Rows from `first` on that are one place with the row so far before them, and not with the other
/// side of the lap.
std::size_t linked(const PlaceMap& map, std::size_t first, std::size_t before) {
  std::size_t count = 0;
  for (std::size_t row = first; row < map.size(); ++row) {
    count += static_cast<std::size_t>(map.same_place(row, row - before));
    EXPECT_FALSE(map.same_place(row, row - lap / 2)) << row;
  }
  return count;
}

TEST(VisitFinder, LinksEachLapToTheFirst) {
  const PlaceMap map = map_of(laps(3), {}, 3 * lap);
  EXPECT_GE(linked(map, lap, lap), 2 * lap - 20);
  EXPECT_GE(linked(map, 2 * lap, 2 * lap), lap - 10);
}

/// Whatever is asked for, it takes no more memory, and changes nothing beyond the drive's length.
TEST(VisitFinder, AnyNumberOfNewestFramesMayBeNoPlaces) {
  MatcherConfig config;
  config.exclude = 1'000'000'000;
  const PlaceMap map = map_of(laps(3), config, 3 * lap);
  for (std::size_t row = 0; row < map.size(); ++row) {
    EXPECT_EQ(map.first_visit(row), map.order().number(row));
  }
  const Capacity capacity{map.capacity(), map.descriptor_size()};
  EXPECT_EQ(Detector::bytes_needed(config, capacity), Detector::bytes_needed({}, capacity));
}

TEST(VisitFinder, BlamesNothingButThatThereAreNoPlaces) {
  const PlaceMap map({}, {1, 16});
  const std::string message = test::setup_error([&] { const VisitFinder visits({}, map, 0); });
  EXPECT_TRUE(message.starts_with("places: 0 ")) << message;
}

TEST(VisitFinder, LinksNothingWhereNothingComesTwice) {
  const PlaceMap map = map_of(test::way(1, 3 * lap, 0.3F, 1), {}, 3 * lap);
  EXPECT_EQ(linked(map, lap, lap), 0U);
}

/// A revisit of 40 frames that see little is sure enough to be linked, but for a first loop it is
/// not sure enough to be accepted: such a drive may as well have come to a place that looks alike.
TEST(VisitFinder, LinksNothingOfADriveOfWhichNoLoopIsAccepted) {
  std::size_t linked_while_driven = 0;
  for (const std::uint32_t seed : {3U, 6U}) {
    Vectors drive = test::way(seed, 300, 4.0F, 1, 256);
    const Vectors again = test::way(seed, 300, 4.0F, 2, 256);
    drive.insert(drive.end(), again.begin() + 100, again.begin() + 140);
    const auto visits = [](const PlaceMap& map) {
      std::size_t count = 0;
      for (std::size_t row = 0; row < map.size(); ++row) {
        count += static_cast<std::size_t>(map.first_visit(row) != map.order().number(row));
      }
      return count;
    };
    MatcherConfig closing;
    closing.use = Use::close_loops;
    closing.standardisation.on = false;
    PlaceMap own(closing, {drive.size(), 256});
    Detector detector(closing, own);
    for (const auto& descriptor : drive) static_cast<void>(detector.step(descriptor));
    static_cast<void>(detector.finish());
    linked_while_driven += visits(own);
    MatcherConfig localising;
    localising.standardisation.on = false;
    EXPECT_EQ(visits(map_of(drive, localising, drive.size())), 0U) << seed;
  }
  EXPECT_GT(linked_while_driven, 60U);
}

/// All laps but one would count as wrong rows, as good as the right one.
TEST(VisitFinder, LetsARobotLocaliseInLaps) {
  const Vectors query = laps(1, 9);
  const MatcherConfig config;
  for (const bool looks : {true, false}) {
    SCOPED_TRACE(looks);
    PlaceMap map = map_of(laps(5), config, looks ? 5 * lap : 0);
    Detector detector(config, map);
    std::size_t accepted = 0;
    const auto take = [&](std::span<const Answer> answers) {
      for (const Answer& answer : answers) {
        if (answer.gate != Gate::match) continue;
        ++accepted;
        const auto off = static_cast<std::size_t>(answer.match->place) % lap;
        EXPECT_LE(off > answer.frame ? off - answer.frame : answer.frame - off, 2U);
      }
    };
    for (const auto& descriptor : query) take(detector.step(descriptor).answers);
    take(detector.finish());
    if (looks) {
      EXPECT_GE(accepted, lap - 10);
    } else {
      EXPECT_LT(accepted, lap / 2);
    }
  }
}

/// What is blank cannot be read while the drive's loops are closed, but is a place of the map.
TEST(VisitFinder, KeepsRowsInStepWhereFramesAreBlank) {
  Vectors drive = laps(2);
  for (std::size_t i = 60; i < 70; ++i) std::ranges::fill(drive[i], 0.0F);
  const PlaceMap map = map_of(drive, {}, drive.size());
  for (std::uint64_t place = lap + 80; place < 2 * lap - 10; ++place) {
    const auto row = map.order().row_of_number(place);
    ASSERT_TRUE(row);
    const std::uint64_t first = map.first_visit(*row);
    EXPECT_LE(first > place - lap ? first - (place - lap) : place - lap - first, 2U) << place;
  }
}

TEST(VisitFinder, LooksThroughAsManyPlacesAsItWasMadeFor) {
  const PlaceMap map = map_of(laps(3), {}, 2 * lap);
  EXPECT_EQ(linked(map, 2 * lap, 2 * lap), 0U);
  EXPECT_TRUE(map.same_place(lap + 75, 75));
}

/// What closing loops would not take, or would take long for, does not matter here.
TEST(VisitFinder, WorksWhateverTheRobotIsToldToLocaliseBy) {
  MatcherConfig config;
  config.enhance = true;
  config.rwindow = 2 * config.exclude + 2;
  config.sequence_length = 2'000;
  config.candidates = Candidates::all;
  config.relocalising.on = false;
  config.frames_at_once = MatcherConfig::most_frames_at_once;
  const PlaceMap map = map_of(laps(2), config, 2 * lap);
  EXPECT_GE(linked(map, lap, lap), lap - 20);
}

TEST(VisitFinder, IsNeededToLocaliseByProbability) {
  MatcherConfig config;
  EXPECT_TRUE(VisitFinder::is_needed(config));
  config.decision = Decision::uniqueness;
  EXPECT_FALSE(VisitFinder::is_needed(config));
  config = {};
  config.use = Use::close_loops;
  EXPECT_FALSE(VisitFinder::is_needed(config));
}

}  // namespace
}  // namespace seqloop
