// SPDX-License-Identifier: MIT
// What becomes of places when the map is full, and what is answered from then on.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <span>

#include "core/matcher.hpp"
#include "core/shown_drive.hpp"
#include "core/ways.hpp"
#include "expect_setup_error.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

/// How a detector can be set up to close loops.
struct Kind {
  Arithmetic arithmetic;
  Candidates candidates;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << "arithmetic " << static_cast<int>(kind.arithmetic) << ", candidates "
       << static_cast<int>(kind.candidates);
}

class FullMaps : public testing::TestWithParam<Kind> {
 protected:
  [[nodiscard]] static MatcherConfig closing(FullMap full_map) {
    MatcherConfig config;
    config.arithmetic = GetParam().arithmetic;
    config.candidates = GetParam().candidates;
    config.use = Use::close_loops;
    config.exclude = 30;
    config.full_map = full_map;
    return config;
  }
};

/// The same way several times over, each time a little different.
oracle::Vectors laps(std::size_t count, std::size_t frames) {
  oracle::Vectors laps;
  for (std::size_t lap = 0; lap < count; ++lap) {
    for (auto& seen : oracle::drive(11, frames, 64, 0.2F + 0.01F * static_cast<float>(lap))) {
      laps.push_back(std::move(seen));
    }
  }
  return laps;
}

TEST_P(FullMaps, ForgettingTheOldestFindsTheNewestPlacesByTheirNumbers) {
  constexpr std::size_t lap = 150;
  constexpr std::size_t capacity = 200;
  const MatcherConfig config = closing(FullMap::forget_oldest);
  PlaceMap map(config, {capacity, 64});
  Detector detector(config, map);
  std::size_t right = 0;
  std::size_t answers = 0;
  for (const auto& seen : laps(5, lap)) {
    const FrameReport report = detector.step(seen);
    EXPECT_FALSE(report.map_full);
    if (!report.match) continue;
    const std::size_t frames = static_cast<std::size_t>(report.newest) + 1;
    EXPECT_GE(report.match->place + capacity, frames) << "only the newest places are there";
    EXPECT_LT(report.match->place + config.exclude, *report.frame);
    EXPECT_EQ(map.order().number(0), frames - std::min(frames, capacity));
    // Just after a lap began, the window still holds the end of the one before.
    const std::uint64_t at = *report.frame % lap;
    if (report.gate != Gate::match || *report.frame < lap || at < 15 || at > 140) continue;
    ++answers;
    right += report.match->place == *report.frame - lap;
    EXPECT_NEAR(static_cast<double>(report.match->place), static_cast<double>(*report.frame - lap),
                2.0);
  }
  EXPECT_GT(answers, 4 * (140 - 15) - 40U);
  EXPECT_GT(right, answers - answers / 20);
}

TEST_P(FullMaps, RefusingKeepsTheFirstPlaces) {
  constexpr std::size_t lap = 150;
  const MatcherConfig config = closing(FullMap::refuse);
  PlaceMap map(config, {lap, 64});
  Detector detector(config, map);
  std::size_t right = 0;
  for (const auto& seen : laps(4, lap)) {
    const FrameReport report = detector.step(seen);
    EXPECT_EQ(report.map_full, report.newest >= lap);
    right += report.match && *report.frame >= lap && report.match->place == *report.frame % lap;
  }
  EXPECT_TRUE(map.order().straight());
  EXPECT_GE(right, 3 * (lap - 30));
}

/// A drive that halts: where on the way each of its frames is.
struct HaltingDrive {
  oracle::Vectors seen;
  std::vector<std::size_t> way;
};

HaltingDrive halting_drive(std::size_t length, std::size_t halt_every, std::size_t halt) {
  const oracle::Vectors way = oracle::drive(12, length, 64, 0.2F);
  std::mt19937 random(12);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  HaltingDrive drive;
  for (std::size_t at = 0; at < length; ++at) {
    const std::size_t frames = at % halt_every == halt_every - 1 ? halt : 1;
    for (std::size_t frame = 0; frame < frames; ++frame) {
      std::vector<float> seen = way[at];
      for (float& value : seen) value += noise(random);
      normalise(seen);
      drive.seen.push_back(seen);
      drive.way.push_back(at);
    }
  }
  return drive;
}

TEST_P(FullMaps, ThinningKeepsTheWayAndDropsTheHalts) {
  constexpr std::size_t length = 300;
  constexpr std::size_t capacity = 700;
  MatcherConfig config = closing(FullMap::thin);
  config.keyframes = false;                            // halts would take no room at all
  HaltingDrive drive = halting_drive(length, 30, 71);  // 700 frames of 1,000 stand still
  ASSERT_EQ(drive.seen.size(), 1'000U);
  PlaceMap map(config, {capacity, 64});
  Detector detector(config, map);
  for (const auto& seen : drive.seen) EXPECT_FALSE(detector.step(seen).map_full);

  std::set<std::size_t> kept;
  for (std::size_t row = 0; row < map.size(); ++row) {
    kept.insert(drive.way[static_cast<std::size_t>(map.order().number(row))]);
  }
  std::printf("kept %zu of %zu\n", kept.size(), length);
  EXPECT_EQ(map.size(), capacity);
  EXPECT_GE(kept.size(), length * 95 / 100);

  // Again, without halts, while the map thins out further.
  std::size_t right = 0;
  std::size_t answers = 0;
  const oracle::Vectors again = oracle::drive(12, length, 64, 0.4F);
  const auto judge = [&](std::span<const Answer> due) {
    for (const Answer& answer : due) {
      if (answer.gate != Gate::match) continue;
      ++answers;
      const std::size_t found = drive.way[static_cast<std::size_t>(answer.match->place)];
      const std::size_t truth = drive.way[static_cast<std::size_t>(answer.frame)];
      right += std::max(found, truth) - std::min(found, truth) <= 2;
    }
  };
  for (std::size_t at = 0; at < length; ++at) {
    const FrameReport report = detector.step(again[at]);
    drive.way.push_back(at);
    if (at >= 30) judge(report.answers);
  }
  judge(detector.finish());
  std::printf("%zu of %zu right\n", right, answers);
  EXPECT_GT(answers, 200U);
  EXPECT_GE(right, answers * 95 / 100);
}

INSTANTIATE_TEST_SUITE_P(Kinds, FullMaps,
                         testing::Values(Kind{Arithmetic::float32, Candidates::all},
                                         Kind{Arithmetic::float32, Candidates::adaptive},
                                         Kind{Arithmetic::int8, Candidates::all},
                                         Kind{Arithmetic::int8, Candidates::ranges},
                                         Kind{Arithmetic::int8, Candidates::adaptive},
                                         Kind{Arithmetic::sketch, Candidates::all},
                                         Kind{Arithmetic::sketch, Candidates::adaptive}));

// A covered lens, or a dark room, for longer than the map has places.
TEST(FullMap, FramesThatCannotBeReadDoNotFillIt) {
  MatcherConfig config;
  config.use = Use::close_loops;
  config.exclude = 30;
  config.full_map = FullMap::forget_oldest;
  constexpr std::uint64_t covered = 1000;
  PlaceMap map(config, {400, 64});
  Detector detector(config, map);
  const oracle::Vectors drive = laps(2, 150);
  std::size_t right = 0;
  const auto count = [&](std::span<const Answer> answers) {
    for (const Answer& answer : answers) {
      if (answer.gate != Gate::match) continue;
      EXPECT_NEAR(static_cast<double>(answer.frame - answer.match->frame()), 150.0 + covered, 3.0);
      ++right;
    }
  };
  for (std::size_t i = 0; i < 150; ++i) count(detector.step(drive[i]).answers);
  const std::size_t places = map.size();
  for (std::uint64_t i = 0; i < covered; ++i) {
    const FrameReport report = detector.step({});
    EXPECT_FALSE(report.map_full);
    count(report.answers);
  }
  EXPECT_LE(map.size(), places + config.sequence_length);
  for (std::size_t i = 150; i < 300; ++i) count(detector.step(drive[i]).answers);
  count(detector.finish());
  EXPECT_GE(right, 130U);
}

TEST(FullMap, LoopsOntoTheWindowItselfAreScoredAsDefinedWhenPlacesGo) {
  for (const FullMap full_map : {FullMap::forget_oldest, FullMap::thin}) {
    for (const std::size_t exclude : {1U, 5U, 9U, 10U}) {
      MatcherConfig config = paper(Candidates::all, 20, Use::close_loops);
      config.exclude = exclude;
      config.full_map = full_map;
      PlaceMap map(config, {60, 16});
      Detector detector(config, map);
      oracle::ShownDrive shown(config, map, {});
      const Work most = Detector::most_work(config, {60, 16});
      std::size_t answers = 0;
      for (const auto& descriptor : oracle::drive(5, 200, 16)) {
        const FrameReport report = detector.step(descriptor);
        shown.step(descriptor);
        EXPECT_LE(report.work.distances, most.distances) << "exclude " << exclude;
        if (report.match) {
          ++answers;
          const auto scored = shown.score(*shown.row_of(report.match->place));
          ASSERT_TRUE(scored);
          ASSERT_NEAR(report.match->score, scored->score, 1e-5) << "exclude " << exclude;
        }
        if (report.newest % 20 == 7) {
          detector.skip(15);
          shown.skip(15);
        }
      }
      EXPECT_GT(answers, 100U);
    }
  }
}

MatcherConfig thinning_frame_by_frame() {
  MatcherConfig config = paper(Candidates::all, 0, Use::close_loops);
  config.exclude = 1;
  config.full_map = FullMap::thin;
  return config;
}

// Where every place is as near to the next as any other, none of them may lose all its neighbours.
TEST(FullMap, ThinningAnEvenDriveLeavesItEven) {
  constexpr std::size_t capacity = 200;
  const MatcherConfig config = thinning_frame_by_frame();
  PlaceMap map(config, {capacity, 2});
  Detector detector(config, map);
  for (std::size_t frame = 0; frame < 3 * capacity; ++frame) {
    const float angle = 0.002F * static_cast<float>(frame);
    static_cast<void>(detector.step(std::vector{std::cos(angle), std::sin(angle)}));
  }
  std::uint64_t widest = 0;
  for (std::size_t row = 1; row < capacity; ++row) {
    widest = std::max(widest, map.order().number(row) - map.order().number(row - 1));
  }
  EXPECT_LE(widest, 9U);
}

TEST(FullMap, AThinnedMapKnowsWherePlacesHaveGone) {
  constexpr std::size_t capacity = 60;
  const MatcherConfig config = thinning_frame_by_frame();
  PlaceMap map(config, {capacity, 16});
  Detector detector(config, map);
  for (const auto& seen : oracle::drive(5, 5 * capacity, 16)) {
    static_cast<void>(detector.step(seen));
    const std::size_t newest = map.size() - 1;
    EXPECT_TRUE(map.has_all(newest > 0 ? newest - 1 : 0, newest));
  }
  EXPECT_FALSE(map.has_all(0, capacity - 1));
  PlaceMap loaded(config, {capacity, 16});
  std::vector<std::byte> bytes(map.rows().saved_size());
  for (std::size_t row = 0; row < capacity; ++row) {
    map.rows().save(map.order().slot(row), bytes);
    ASSERT_TRUE(loaded.add_saved({map.order().number(row), map.order().frame(row), bytes}));
  }
  for (std::size_t row = 1; row < capacity; ++row) {
    const bool follows = map.order().number(row) == map.order().number(row - 1) + 1;
    EXPECT_EQ(map.has_all(row - 1, row), follows) << row;
    EXPECT_EQ(loaded.has_all(row - 1, row), follows) << row;
  }
}

TEST(FullMap, WhatIsNeededElsewhereStaysHoweverManyFramesComeAtOnce) {
  constexpr std::size_t capacity = 120;
  constexpr std::size_t at_once = 20;
  constexpr std::size_t needed = 60;
  MatcherConfig config;
  config.use = Use::close_loops;
  config.exclude = 30;
  config.full_map = FullMap::forget_oldest;
  config.frames_at_once = at_once;
  PlaceMap map(config, {capacity, 64});
  Detector detector(config, map);
  const oracle::Vectors seen = laps(2, 200);
  std::vector<FrameReport> reports(at_once);
  const auto take = [&](std::size_t first) {
    const std::vector<std::span<const float>> frames(
        seen.begin() + static_cast<std::ptrdiff_t>(first),
        seen.begin() + static_cast<std::ptrdiff_t>(first + at_once));
    EXPECT_EQ(detector.steps(frames, reports), at_once);
  };
  const auto first_place = [&map] { return map.order().number(0); };
  std::size_t frame = 0;
  for (; frame < 2 * capacity; frame += at_once) take(frame);
  EXPECT_EQ(first_place(), capacity) << "nobody needs any";

  detector.keep_newest(needed);
  const std::uint64_t oldest_needed = map.order().next_number() - needed;
  for (; frame < 2 * capacity + 80; frame += at_once) take(frame);
  EXPECT_EQ(first_place(), oldest_needed);
  EXPECT_TRUE(reports.back().map_full) << "rather no place than one that nobody has saved";
  detector.skip(5);
  EXPECT_EQ(first_place(), oldest_needed) << "nor for frames that never came";
  EXPECT_EQ(map.order().number(map.size() - 1), oldest_needed + capacity - 1);
  EXPECT_EQ(map.order().next_number(), frame + 5) << "frames without a place have a number, too";

  detector.keep_newest(needed);
  take(frame);
  EXPECT_EQ(first_place(), oldest_needed + at_once) << "now they may go";
}

// A frame waits for its answer while the place that it was at is forgotten.
TEST(FullMap, APlaceThatIsForgottenBeforeItsAnswerIsNotNamed) {
  constexpr std::size_t lap = 200;
  for (const std::size_t more : {3U, 12U, 25U, 140U}) {
    SCOPED_TRACE(more);
    MatcherConfig config;
    config.use = Use::close_loops;
    config.full_map = FullMap::forget_oldest;
    PlaceMap map(config, {lap + more, 64});
    Detector detector(config, map);
    std::size_t accepted = 0;
    for (const auto& seen : laps(5, lap)) {
      const FrameReport report = detector.step(seen);
      for (const Answer& answer : report.answers) {
        if (answer.gate != Gate::match) continue;
        ++accepted;
        EXPECT_GE(answer.match->place, map.order().number(0));
        EXPECT_NEAR(static_cast<double>(answer.match->place),
                    static_cast<double>(answer.frame - lap), 2.0);
      }
    }
    std::printf("%zu places more than a lap has: %zu accepted\n", more, accepted);
    EXPECT_EQ(accepted > 0, more > 20);
  }
}

// Where a row goes that lies between two that are believed in, these are one from then on, and do
// not share what is believed: then 88 would be accepted.
TEST(FullMap, AThinnedMapGoesOnFindingTheRobot) {
  constexpr std::size_t lap = 150;
  MatcherConfig config;
  config.use = Use::close_loops;
  config.full_map = FullMap::thin;
  PlaceMap map(config, {135, 256});
  Detector detector(config, map);
  std::size_t accepted = 0;
  for (std::uint32_t visit = 1; visit <= 6; ++visit) {
    for (const auto& seen : test::way(3, lap, 0.5F, visit)) {
      const FrameReport report = detector.step(seen);
      for (const Answer& answer : report.answers) accepted += answer.gate == Gate::match ? 1U : 0U;
    }
  }
  std::printf("%zu accepted\n", accepted);
  EXPECT_GT(accepted, 110U);
}

/// A way of which some stretches change faster than others, so that one is thinned out before
/// another.
oracle::Vectors uneven_lap(std::size_t frames, std::uint32_t visit) {
  const oracle::Vectors points = test::way(3, frames, 0.0F, 0, 256, 0.7F);
  std::mt19937 random(visit);
  oracle::Vectors lap;
  float at = 0.0F;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto point = static_cast<std::size_t>(at);
    const float share = at - static_cast<float>(point);
    lap.push_back(test::between(points[point], points[point + 1], share, 0.1F, random));
    at += frame / 25 % 2 == 0 ? 0.8F : 0.15F;
  }
  return test::unit(std::move(lap));
}

// Lines run as if the rows that are left were as far apart as the frames that they were.
TEST(FullMap, AThinnedMapSaysWhereToAFewFrames) {
  constexpr std::size_t lap = 300;
  constexpr std::size_t ends = 20;  // one lap goes on as the next
  for (const std::size_t places : {340U, 400U, 600U}) {
    MatcherConfig config;
    config.use = Use::close_loops;
    config.full_map = FullMap::thin;
    PlaceMap map(config, {places, 256});
    Detector detector(config, map);
    std::size_t accepted = 0;
    std::size_t off = 0;
    for (std::uint32_t visit = 1; visit <= 5; ++visit) {
      for (const auto& seen : uneven_lap(lap, visit)) {
        const FrameReport report = detector.step(seen);
        for (const Answer& answer : report.answers) {
          const auto at = static_cast<std::size_t>(answer.frame) % lap;
          if (answer.gate != Gate::match || at < ends || at + ends > lap) continue;
          const auto said = static_cast<std::size_t>(answer.match->frame()) % lap;
          ++accepted;
          off += std::max(at, said) - std::min(at, said) > 10 ? 1U : 0U;
        }
      }
    }
    std::printf("%zu places: %zu accepted, %zu off by more than 10\n", places, accepted, off);
    EXPECT_GT(accepted, 900U);
    EXPECT_LE(off, 5U);
  }
}

/// A map of one earlier drive, which is full.
PlaceMap full_of(const oracle::Vectors& places, const MatcherConfig& config) {
  PlaceMap map(config, {places.size(), places.front().size(), 2});
  fill(map, places);
  return map;
}

// A map so small that an earlier drive goes row by row, its last one too: the row behind that one
// is the running drive's first.
TEST(FullMap, APlaceThatIsForgottenAtTheEndOfASessionIsNoneOfTheNext) {
  MatcherConfig config;
  config.use = Use::close_loops;
  config.full_map = FullMap::thin;
  config.exclude = 2;
  config.vmin = 0.0;
  config.standardisation.on = false;
  std::size_t named = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const oracle::Vectors known = test::way(seed, least_places(config), 0.3F, 1);
    PlaceMap map = full_of(known, config);
    Detector detector(config, map);
    const oracle::Vectors again = test::way(seed, known.size(), 0.3F, 2);
    for (const auto& seen : again) EXPECT_TRUE(detector.step(seen).answers.empty());
    for (const Answer& answer : detector.finish()) {
      if (!answer.match) continue;
      ++named;
      EXPECT_LT(answer.match->place, known.size())
          << "frame " << answer.frame << ", seed " << seed << ": a place that was new then";
    }
  }
  std::printf("%zu answers name a place\n", named);
}

TEST(FullMap, TheEndsOfSessionsStayWhereOtherRowsMayGo) {
  for (std::size_t more = 60; more < 70; ++more) {
    SCOPED_TRACE(more);
    MatcherConfig config = paper(Candidates::all, 5, Use::close_loops);
    config.full_map = FullMap::thin;
    config.exclude = 20;
    const oracle::Vectors known = oracle::drive(3, config.exclude + 5 + more, 16);
    PlaceMap map = full_of(known, config);
    Detector detector(config, map);
    for (const auto& seen : oracle::drive(4, 200, 16)) {
      static_cast<void>(detector.step(seen));
      EXPECT_EQ(map.order().number(0), 0U);
      ASSERT_TRUE(map.order().row_of_number(known.size() - 1)) << "the last";
    }
  }
}

TEST(FullMap, OfOnePlaceLeavesRoomForAnother) {
  for (const FullMap how : {FullMap::forget_oldest, FullMap::thin}) {
    MatcherConfig config{.use = Use::close_loops, .full_map = how};
    PlaceMap map(config, {1, 16});
    const oracle::Vectors drive = oracle::drive(7, 3, 16);
    ArenaMemory memory(1 << 20, {});
    Arena arena(memory.span());
    QueryHistory queries(arena, DescriptorForm(config, 16), 4);
    for (std::uint64_t frame = 0; frame < drive.size(); ++frame) {
      queries.push(drive[static_cast<std::size_t>(frame)]);
      const PlaceMap::Taken taken = map.take(queries.rows(), queries.row_of(frame), frame, 0);
      EXPECT_EQ(taken.slot, 0U);
      EXPECT_EQ(taken.removed.has_value(), frame > 0);
    }
    EXPECT_EQ(map.order().frame(0), 2U);
  }
}

TEST(FullMap, AllPlacesMayBeNeeded) {
  MatcherConfig config;
  config.use = Use::close_loops;
  config.full_map = FullMap::forget_oldest;
  PlaceMap map(config, {200, 64});
  Detector detector(config, map);
  detector.keep_newest(std::numeric_limits<std::size_t>::max());
  bool full = false;
  for (const auto& seen : laps(2, 150)) full = detector.step(seen).map_full;
  EXPECT_TRUE(full);
  EXPECT_EQ(map.order().number(0), 0U);
}

// Places that are no candidates yet do not go.
TEST(FullMap, AMapWithoutRoomForCandidatesIsRefused) {
  for (const FullMap full_map : {FullMap::forget_oldest, FullMap::thin}) {
    MatcherConfig config = paper(Candidates::adaptive, 5, Use::close_loops);
    config.relocalising.on = true;
    config.exclude = 30;
    config.full_map = full_map;
    const std::size_t least = least_places(config);
    PlaceMap small(config, {least - 1, 16});
    EXPECT_THROW(Detector(config, small), SetupError);
    PlaceMap map(config, {least, 16});
    Detector detector(config, map);
    std::size_t answered = 0;
    for (const auto& descriptor : oracle::drive(5, 100, 16)) {
      const FrameReport report = detector.step(descriptor);
      EXPECT_FALSE(report.map_full);
      answered += report.newest >= least && report.match.has_value();
    }
    EXPECT_GT(answered, 50U);
  }
}

TEST(FullMap, ThePlanOfADetectorIsRefusedWithWhatItIsRefusedWith) {
  MatcherConfig config;
  config.use = Use::close_loops;
  config.full_map = FullMap::thin;
  PlaceMap map(config, {least_places(config) - 1, 16});
  config.k = 0;
  const std::string planned = test::setup_error([&] {
    static_cast<void>(Detector::plan(config, {map.capacity(), 16}));
  });
  EXPECT_TRUE(test::says(planned, "k: 0 is not between"));
  EXPECT_TRUE(test::says(planned, "places: 57 leave no candidates once the map is full; take 58"));
  EXPECT_EQ(planned, test::setup_error([&] { const Detector detector(config, map); }));
}

}  // namespace
}  // namespace seqloop
