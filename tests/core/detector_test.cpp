// SPDX-License-Identifier: MIT
// What a step promises beside the right answer: bounded work, fixed memory, honest gates.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "core/matcher.hpp"
#include "expect_setup_error.hpp"

namespace seqloop {
namespace {

oracle::Vectors two_laps(std::uint32_t seed, std::size_t frames, std::size_t size) {
  oracle::Vectors laps = oracle::drive(seed, frames, size, 0.2F);
  const oracle::Vectors second = oracle::drive(seed, frames, size, 0.3F);
  laps.insert(laps.end(), second.begin(), second.end());
  return laps;
}

// It may begin anywhere on the map, and has to be standardised soon as the places there were.
TEST(Detector, StartsADriveThatIsLocalisedFromAThirdOfWhatTheMapKnows) {
  const oracle::Vectors known = oracle::drive(5, 40, 16);
  for (const auto& [prior, third] :
       std::array<std::pair<std::size_t, std::size_t>, 4>{{{15, 5}, {10, 3}, {2, 1}, {1, 1}}}) {
    MatcherConfig config{.use = Use::localise};
    config.standardisation.prior_frames = prior;
    PlaceMap map(config, {known.size(), known.front().size()});
    for (const auto& descriptor : known) ASSERT_TRUE(map.learn(descriptor));
    ASSERT_TRUE(map.add(known.front()));
    EXPECT_EQ(Detector(config, map).statistics().frames(), third) << prior;
  }
}

TEST(Detector, NeverComputesMoreThanThePlanSays) {
  for (const Candidates candidates : {Candidates::all, Candidates::ranges, Candidates::adaptive}) {
    for (const Use use : {Use::localise, Use::close_loops}) {
      for (const std::size_t exclude : {1U, 5U, 6U, 40U}) {
        MatcherConfig config = paper(candidates, 20, use);
        config.exclude = exclude;
        config.enhance = exclude > 5;
        config.reinit = 30;
        const oracle::Vectors drive = two_laps(9, 80, 12);
        const bool closing = use == Use::close_loops;
        const std::size_t places = closing ? drive.size() : 80;
        const Work most = Detector::most_work(config, {places, 12});
        std::uint64_t all = 0;
        std::size_t change = 0;
        for (const FrameReport& report :
             reports(closing ? oracle::Vectors{} : oracle::drive(9, 80, 12), drive, config)) {
          EXPECT_LE(report.work.distances, most.distances);
          EXPECT_LE(report.work.line_sums, most.line_sums);
          EXPECT_LE(report.work.candidates, most.candidates);
          all += report.work.distances;
          if (candidates == Candidates::adaptive) change += ChangeDegree::reach;
        }
        EXPECT_LE(all, places * drive.size() + change) << "each difference at most once";
      }
    }
  }
}

TEST(Detector, StaysWithinThePlanWhenLoopsAreClosedOntoTheWindowItself) {
  for (const auto& [ds, exclude, vmin] : {std::tuple{200U, 1U, 0.8}, std::tuple{100U, 5U, 0.5},
                                          std::tuple{40U, 1U, 0.0}, std::tuple{40U, 6U, 0.0}}) {
    MatcherConfig config = paper(Candidates::all, ds, Use::close_loops);
    config.enhance = exclude > 5;
    config.exclude = exclude;
    config.vmin = vmin;
    const Work most = Detector::most_work(config, {300, 4});
    for (const FrameReport& report : reports({}, oracle::drive(3, 300, 4), config)) {
      EXPECT_LE(report.work.distances, most.distances) << ds;
    }
  }
}

/// What two reports say, but for the work that it took.
void expect_same_answer(const FrameReport& a, const FrameReport& b) {
  ASSERT_EQ(a.newest, b.newest);
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.gate, b.gate);
  ASSERT_EQ(a.match.has_value(), b.match.has_value());
  if (!a.match) return;
  EXPECT_EQ(a.match->place, b.match->place);
  EXPECT_EQ(a.match->score, b.match->score);
  EXPECT_EQ(a.match->velocity, b.match->velocity);
}

TEST(Detector, AFrameThatNeverCameIsOneThatCannotBeReadWithoutTheSearch) {
  for (const Use use : {Use::localise, Use::close_loops}) {
    for (const std::size_t exclude : {1U, 6U, 30U}) {
      MatcherConfig config = paper(Candidates::all, 12, use);
      config.exclude = exclude;
      config.enhance = exclude > 5;
      config.rwindow = 10;
      config.standardisation.on = use == Use::close_loops;
      const oracle::Vectors drive = two_laps(4, 80, 12);
      PlaceMap skipped_map =
          use == Use::localise ? map_of(drive, config) : PlaceMap(config, {160, 12});
      PlaceMap stepped_map =
          use == Use::localise ? map_of(drive, config) : PlaceMap(config, {160, 12});
      Detector skipping(config, skipped_map);
      Detector stepping(config, stepped_map);
      const Work most = Detector::most_work(config, {160, 12});
      std::size_t skipped = 0;
      for (std::size_t frame = 0; frame < drive.size();) {
        const FrameReport report = skipping.step(drive[frame]);
        expect_same_answer(report, stepping.step(drive[frame]));
        EXPECT_LE(report.work.distances, most.distances);
        const std::size_t gap = std::min(frame % 5 == 0 ? frame % 13 : 0, drive.size() - frame - 1);
        skipping.skip(gap);
        for (std::size_t i = 0; i < gap; ++i) static_cast<void>(stepping.step({}));
        skipped += gap;
        frame += 1 + gap;
      }
      EXPECT_GT(skipped, 50U);
      EXPECT_EQ(skipped_map.size(), stepped_map.size());
    }
  }
}

TEST(Detector, AGapLongerThanTheWindowBeginsItAnew) {
  for (const Candidates candidates : {Candidates::all, Candidates::ranges, Candidates::adaptive}) {
    const MatcherConfig config = paper(candidates, 10);
    const oracle::Vectors reference = oracle::drive(7, 200, 16);
    PlaceMap map = map_of(reference, config);
    Detector interrupted(config, map);
    for (std::size_t frame = 0; frame < 60; ++frame) {
      static_cast<void>(interrupted.step(reference[frame]));
    }
    interrupted.skip(1);
    interrupted.skip(std::numeric_limits<std::uint64_t>::max());
    interrupted.skip(1);
    Detector fresh(config, map);
    for (std::size_t frame = 150; frame < 180; ++frame) {
      FrameReport expected = fresh.step(reference[frame]);
      expected.newest += 61;
      if (expected.frame) *expected.frame += 61;
      const FrameReport report = interrupted.step(reference[frame]);
      expect_same_answer(report, expected);
      EXPECT_EQ(report.gate == Gate::warming_up, frame < 160);
      EXPECT_EQ(report.full_search, expected.full_search);
      if (report.match) {
        EXPECT_EQ(report.match->head, frame);
      }
    }
  }
}

TEST(Detector, FindsItsWayAfterAShortGapWithoutAFullSearch) {
  for (const Candidates candidates : {Candidates::ranges, Candidates::adaptive}) {
    const MatcherConfig config = paper(candidates, 20);
    const oracle::Vectors reference = oracle::drive(7, 300, 16);
    PlaceMap map = map_of(reference, config);
    Detector detector(config, map);
    std::size_t frame = 0;
    for (; frame < 60; ++frame) static_cast<void>(detector.step(reference[frame]));
    detector.skip(20);
    frame += 20;
    for (; frame < 140; ++frame) {
      const FrameReport report = detector.step(reference[frame]);
      EXPECT_FALSE(report.full_search);
      ASSERT_TRUE(report.match) << frame;
      if (frame >= 100) {
        EXPECT_EQ(report.match->head, frame) << "the gap has left the window";
      }
    }
  }
}

TEST(Detector, GapsOfNothingAndBeforeTheFirstFrameAreNone) {
  const oracle::Vectors drive = oracle::drive(7, 30, 16);
  PlaceMap map = map_of(drive, paper(Candidates::all, 4));
  Detector detector(paper(Candidates::all, 4), map);
  detector.skip(3);
  EXPECT_EQ(detector.step(drive[0]).newest, 0U);
  detector.skip(0);
  EXPECT_EQ(detector.step(drive[1]).newest, 1U);
  MatcherConfig single = paper(Candidates::all, 0);
  Detector frames(single, map);
  static_cast<void>(frames.step(drive[0]));
  frames.skip(2);
  EXPECT_EQ(frames.step(drive[9]).match->place, 9U);
}

TEST(Detector, AGapBetweenTwoRecordingsIsOfNeither) {
  const oracle::Vectors drive = oracle::drive(3, 60, 16);
  MatcherConfig config;
  config.use = Use::close_loops;
  config.keyframes = false;
  PlaceMap map(config, {100, 16});
  Detector detector(config, map);
  for (const auto& seen : drive) static_cast<void>(detector.step(seen));
  static_cast<void>(detector.finish());
  detector.skip(3);
  EXPECT_EQ(map.size(), 60U) << "nothing was seen there";
  EXPECT_EQ(detector.step(drive[0]).newest, 60U);
  detector.skip(3);
  EXPECT_EQ(detector.step(drive[1]).newest, 64U);
}

TEST(Detector, ADescriptorThatIsNotUnitDoesNotSpoilTheStatistics) {
  const oracle::Vectors drive = oracle::drive(6, 200, 16, 0.1F);
  MatcherConfig config;
  config.candidates = Candidates::all;
  config.decision = Decision::uniqueness;
  PlaceMap map = map_of(drive, config);
  Detector detector(config, map);
  std::size_t right = 0;
  for (std::size_t frame = 0; frame < 200; ++frame) {
    std::vector<float> seen = drive[frame];
    if (frame == 50) seen[3] = 1e6F;
    if (frame == 60) seen[3] = 3e38F;
    const FrameReport report = detector.step(seen);
    EXPECT_EQ(report.gate == Gate::frame_error, frame == 50 || frame == 60);
    right += report.match && report.match->place == *report.frame ? 1U : 0U;
  }
  EXPECT_EQ(right, 178U) << "all but the window and the two";
}

TEST(Detector, RefusesAnEnhancementThatWouldNeedTheFuture) {
  MatcherConfig config = paper(Candidates::all, 20, Use::close_loops);
  config.enhance = true;
  config.exclude = 5;
  config.rwindow = 10;
  EXPECT_EQ(validate(config).size(), 1U);
  config.exclude = 6;
  EXPECT_TRUE(validate(config).empty());
  config.rwindow = 1;
  EXPECT_EQ(validate(config).size(), 1U) << "no rows around";
}

TEST(Detector, PatchesNeedNotBeUnitButFiniteAndNotBlank) {
  MatcherConfig config;
  config.candidates = Candidates::all;
  config.arithmetic = Arithmetic::float32;
  config.difference = Difference::mean_absolute;
  config.standardisation.on = false;
  PlaceMap map = map_of(oracle::drive(6, 60, 16), config);
  Detector detector(config, map);
  EXPECT_EQ(detector.step(std::vector<float>(16, 127.5F)).gate, Gate::frame_error) << "blank";
  std::vector<float> patches(16, 127.5F);
  patches[3] = 200.0F;
  EXPECT_EQ(detector.step(patches).gate, Gate::warming_up);
  patches[4] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(detector.step(patches).gate, Gate::frame_error);
}

// Infinite all over, it is as flat as a grey wall.
TEST(Detector, WhatIsNotFiniteIsNoBlankFrame) {
  MatcherConfig config = paper(Candidates::all, 5);
  config.difference = Difference::mean_absolute;
  PlaceMap map = map_of(oracle::drive(6, 60, 16), config);
  Detector detector(config, map);
  for (const float value :
       {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(detector.step(std::vector<float>(16, value)).gate, Gate::frame_error) << value;
  }
  EXPECT_EQ(detector.step(std::vector<float>(16, 127.5F)).gate, Gate::warming_up);
}

TEST(Detector, SpreadsTheExhaustiveWorkEvenly) {
  for (const FrameReport& report :
       reports(oracle::drive(4, 70, 8), oracle::drive(4, 60, 8), paper(Candidates::all, 20))) {
    EXPECT_EQ(report.work.distances, 70U) << "one column a frame, the first included";
  }
}

TEST(Detector, SeveralFramesAtOnceAreAsManySteps) {
  const oracle::Vectors reference = oracle::drive(9, 300, 40);
  oracle::Vectors query = oracle::drive(9, 260, 40, 0.3F);
  query[1].clear();
  query[77] = std::vector<float>(40, 0.0F);
  query[78].clear();
  for (const Use use : {Use::localise, Use::close_loops}) {
    for (const Arithmetic arithmetic :
         {Arithmetic::float32, Arithmetic::int8, Arithmetic::sketch}) {
      for (const Candidates candidates : {Candidates::all, Candidates::adaptive}) {
        for (const std::size_t at_once : {1U, 3U, 32U, 64U}) {
          MatcherConfig config;
          config.use = use;
          config.arithmetic = arithmetic;
          config.candidates = candidates;
          config.sequence_length = 12;
          config.exclude = 30;
          const auto wanted =
              reports(use == Use::localise ? reference : oracle::Vectors{}, query, config);
          config.frames_at_once = at_once;
          PlaceMap map =
              use == Use::localise ? map_of(reference, config) : PlaceMap(config, {260, 40});
          Detector detector(config, map);
          std::vector<FrameReport> given(query.size());
          for (std::size_t first = 0; first < query.size();) {
            // Not always as many as fit.
            const std::size_t count =
                std::min(first % 2 == 0 ? at_once : (at_once + 1) / 2, query.size() - first);
            const std::vector<std::span<const float>> frames(
                query.begin() + static_cast<std::ptrdiff_t>(first),
                query.begin() + static_cast<std::ptrdiff_t>(first + count));
            ASSERT_EQ(detector.steps(frames, std::span(given).subspan(first, count)), count);
            first += count;
          }
          for (std::size_t frame = 0; frame < query.size(); ++frame) {
            expect_same_answer(given[frame], wanted[frame]);
            EXPECT_EQ(given[frame].work, wanted[frame].work) << frame;
            EXPECT_EQ(given[frame].map_full, wanted[frame].map_full);
          }
        }
      }
    }
  }
}

TEST(Detector, TakesNoMoreFramesAtOnceThanItHasRoomFor) {
  const oracle::Vectors reference = oracle::drive(9, 150, 40);
  const oracle::Vectors query = oracle::drive(9, 140, 40, 0.3F);
  const std::vector<std::span<const float>> frames(query.begin(), query.end());
  for (const std::size_t at_once : {1U, 5U, 64U}) {
    for (const std::size_t reports_given : {0U, 99U, 140U}) {
      SCOPED_TRACE(std::to_string(at_once) + " at once, " + std::to_string(reports_given));
      MatcherConfig config;
      config.candidates = Candidates::all;
      config.sequence_length = 12;
      const auto wanted = reports(reference, query, config);
      config.frames_at_once = at_once;
      PlaceMap map = map_of(reference, config);
      Detector detector(config, map);
      std::vector<FrameReport> given(reports_given);
      const std::size_t taken = detector.steps(frames, given);
      EXPECT_EQ(taken, std::min(at_once, reports_given));
      for (std::size_t frame = 0; frame < taken; ++frame) {
        expect_same_answer(given[frame], wanted[frame]);
        EXPECT_EQ(given[frame].work, wanted[frame].work) << frame;
      }
      EXPECT_EQ(detector.step(query[0]).newest, taken);
    }
  }
}

void append(std::vector<Answer>& all, std::span<const Answer> more) {
  all.insert(all.end(), more.begin(), more.end());
}

TEST(Detector, AnswersOfSeveralFramesAreThoseOfAsManySteps) {
  const oracle::Vectors reference = oracle::drive(9, 300, 40);
  oracle::Vectors query = oracle::drive(9, 260, 40, 0.3F);
  query[77].clear();
  for (const Decision decision : {Decision::probability, Decision::uniqueness}) {
    for (const Candidates candidates : {Candidates::all, Candidates::adaptive}) {
      MatcherConfig config;
      config.decision = decision;
      config.candidates = candidates;
      config.frames_at_once = 64;
      PlaceMap map = map_of(reference, config);
      Detector by_one(config, map);
      Detector by_many(config, map);
      std::vector<Answer> wanted;
      std::vector<Answer> given;
      for (const auto& descriptor : query) append(wanted, by_one.step(descriptor).answers);
      append(wanted, by_one.finish());
      std::vector<FrameReport> reports(config.frames_at_once);
      for (std::size_t first = 0; first < query.size(); first += reports.size()) {
        const std::vector<std::span<const float>> frames(
            query.begin() + static_cast<std::ptrdiff_t>(first),
            query.begin() +
                static_cast<std::ptrdiff_t>(std::min(first + reports.size(), query.size())));
        ASSERT_EQ(by_many.steps(frames, reports), frames.size());
        for (std::size_t i = 0; i < frames.size(); ++i) append(given, reports[i].answers);
      }
      append(given, by_many.finish());
      ASSERT_EQ(given.size(), wanted.size());
      EXPECT_GE(given.size(), decision == Decision::probability ? query.size() : 230U);
      for (std::size_t i = 0; i < given.size(); ++i) {
        EXPECT_EQ(given[i].frame, wanted[i].frame);
        EXPECT_EQ(given[i].gate, wanted[i].gate);
        EXPECT_EQ(given[i].match.has_value(), wanted[i].match.has_value());
      }
    }
  }
}

TEST(Detector, ByUniquenessTheCentreFrameIsTheOneAnswer) {
  const oracle::Vectors drive = oracle::drive(2, 120, 30);
  for (const FrameReport& report : reports(drive, drive, paper(Candidates::all, 10))) {
    EXPECT_EQ(report.answers.size(), report.newest < 10 ? 0U : 1U);
    EXPECT_FALSE(report.now);
  }
  PlaceMap map = map_of(drive, paper(Candidates::all, 10));
  Detector detector(paper(Candidates::all, 10), map);
  for (const auto& descriptor : drive) {
    const FrameReport report = detector.step(descriptor);
    if (report.answers.empty()) continue;
    const Answer& answer = report.answers.front();
    EXPECT_EQ(answer.frame, *report.frame);
    EXPECT_EQ(answer.gate, report.gate);
    EXPECT_TRUE(std::isnan(answer.probability));
    ASSERT_EQ(answer.match.has_value(), report.match.has_value());
    if (!answer.match) continue;
    EXPECT_EQ(answer.match->place, report.match->place);
  }
  EXPECT_TRUE(detector.finish().empty());
}

TEST(Detector, ByUniquenessAWindowThatIsNotWholeHasNoAnswer) {
  const oracle::Vectors drive = oracle::drive(2, 120, 30);
  PlaceMap map = map_of(drive, paper(Candidates::all, 10));
  Detector detector(paper(Candidates::all, 10), map);
  std::vector<std::uint64_t> answered;
  for (std::size_t frame = 0; frame < 60; ++frame) {
    const bool bad = frame % 3 == 1;
    if (frame == 30) detector.skip(100);
    for (const Answer& answer :
         detector.step(bad ? std::span<const float>() : drive[frame]).answers) {
      answered.push_back(answer.frame);
    }
  }
  std::vector<std::uint64_t> wanted;
  for (std::uint64_t frame = 5; frame < 55; ++frame) {
    if (frame < 25 || frame >= 35) wanted.push_back(frame);
  }
  EXPECT_EQ(answered, wanted);
}

TEST(Detector, SameInputSameReports) {
  const oracle::Vectors drive = two_laps(2, 120, 30);
  MatcherConfig config;
  config.use = Use::close_loops;
  const auto first = reports({}, drive, config);
  const auto second = reports({}, drive, config);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].gate, second[i].gate);
    EXPECT_EQ(first[i].work, second[i].work);
    ASSERT_EQ(first[i].match.has_value(), second[i].match.has_value());
    if (!first[i].match) continue;
    EXPECT_EQ(first[i].match->place, second[i].match->place);
    EXPECT_EQ(first[i].match->score, second[i].match->score) << "to the last bit";
  }
}

TEST(Detector, LivesInMemoryThatTheCallerGives) {
  MatcherConfig config = paper(Candidates::all, 5);
  PlaceMap map = map_of(oracle::drive(1, 30, 9), config);
  const auto bytes = static_cast<std::size_t>(Detector::bytes_needed(config, {30, 9}));
  const ArenaMemory memory(bytes, {});
  Detector detector(config, map, memory.span());
  EXPECT_EQ(detector.step(oracle::drive(1, 1, 9)[0]).gate, Gate::warming_up);
  EXPECT_THROW(Detector(config, map, memory.span().first(bytes - 1)), SetupError);
  EXPECT_THROW(Detector(config, map, memory.span().subspan(1)), SetupError);
}

TEST(Detector, NamesTheGateAndTheCentreFrame) {
  const oracle::Vectors drive = oracle::drive(6, 40, 16, 0.1F);
  MatcherConfig config = paper(Candidates::all, 10);
  config.max_uniqueness = 0.9F;
  const auto all = reports(drive, drive, config);
  EXPECT_FALSE(all[4].frame.has_value());
  EXPECT_EQ(all[5].frame, 0U);
  EXPECT_EQ(all[9].gate, Gate::warming_up);
  EXPECT_EQ(all[10].gate, Gate::match);
  EXPECT_EQ(all[10].frame, 5U);
  EXPECT_EQ(all[10].match->place, 5U);
  EXPECT_EQ(all[10].match->head, 10U);
  EXPECT_EQ(all[39].frame, 34U);
}

TEST(Detector, AFrameThatCannotBeReadDecidesNothingAndBreaksNothing) {
  const oracle::Vectors drive = oracle::drive(6, 60, 16, 0.1F);
  for (const std::vector<float>& broken :
       {std::vector<float>{}, std::vector<float>(15, 0.1F),
        std::vector<float>(16, std::numeric_limits<float>::quiet_NaN()),
        std::vector<float>(16, std::numeric_limits<float>::infinity())}) {
    for (const bool standardise : {false, true}) {
      MatcherConfig config = paper(Candidates::all, 10);
      config.standardisation.on = standardise;
      PlaceMap map = map_of(drive, config);
      Detector detector(config, map);
      for (std::size_t frame = 0; frame < 60; ++frame) {
        const bool bad = frame == 0 || frame == 30 || frame == 31;
        const FrameReport report = detector.step(bad ? broken : drive[frame]);
        EXPECT_EQ(report.gate == Gate::frame_error, bad) << frame;
        EXPECT_EQ(report.match.has_value(), !bad && frame >= 10) << frame;
        if (report.match) {
          EXPECT_EQ(report.match->place, *report.frame) << frame;
        }
      }
    }
  }
}

TEST(Detector, ABlankFrameIsUnreadableUnlessThePaperIsFollowed) {
  const oracle::Vectors drive = oracle::drive(6, 30, 16, 0.1F);
  for (const bool unreadable : {true, false}) {
    MatcherConfig config = paper(Candidates::all, 6);
    config.blank_is_unreadable = unreadable;
    PlaceMap map = map_of(drive, config);
    Detector detector(config, map);
    (void)detector.step(drive[0]);
    const FrameReport report = detector.step(std::vector<float>(16, 0.0F));
    EXPECT_EQ(report.gate == Gate::frame_error, unreadable);
  }
}

TEST(Detector, SaysWhenTheMapIsFullAndKeepsAnswering) {
  const oracle::Vectors laps = two_laps(8, 150, 16);
  MatcherConfig config = paper(Candidates::all, 10, Use::close_loops);
  config.exclude = 20;
  PlaceMap map(config, {200, 16});
  Detector detector(config, map);
  std::size_t right = 0;
  for (std::size_t frame = 0; frame < laps.size(); ++frame) {
    const FrameReport report = detector.step(laps[frame]);
    EXPECT_EQ(report.map_full, frame >= 200);
    if (report.match && *report.frame >= 160) right += report.match->place == *report.frame - 150;
  }
  EXPECT_GT(right, 120U);
  EXPECT_EQ(map.size(), 200U);
}

/// By uniqueness a map keeps no visits of one place, by which a probability goes.
TEST(Detector, RefusesAMapThatWasMadeForTheOtherDecision) {
  MatcherConfig by_probability{.use = Use::close_loops};
  MatcherConfig by_uniqueness = by_probability;
  by_uniqueness.decision = Decision::uniqueness;
  for (const auto& [own, other] :
       {std::pair(by_probability, by_uniqueness), std::pair(by_uniqueness, by_probability)}) {
    PlaceMap map(own, {200, 16});
    EXPECT_NO_THROW(const Detector detector(own, map));
    const auto& wrong = other;
    EXPECT_TRUE(test::says(test::setup_error([&] { const Detector detector(wrong, map); }),
                           "it was made for another configuration"));
  }
}

TEST(Detector, ListsEveryFaultOfItsSetUp) {
  MatcherConfig config;
  config.sequence_length = 2'001;
  config.vmin = 1.3;
  config.k = 0;
  config.num = 0;
  config.max_uniqueness = std::numeric_limits<float>::quiet_NaN();
  PlaceMap map({}, {3, 3});
  try {
    const Detector detector(config, map);
    FAIL() << "must not be built";
  } catch (const SetupError& error) {
    std::vector<std::string> names;
    for (const Fault& fault : error.faults()) names.push_back(fault.what);
    EXPECT_EQ(names, (std::vector<std::string>{"sequence_length", "vmin", "k", "num",
                                               "max_uniqueness", "map"}));
  }
}

TEST(Detector, PlansNeitherMemoryNorWorkOfWhatItRefuses) {
  MatcherConfig config = paper(Candidates::ranges, 5);
  config.candidates = Candidates{77};
  config.vmin = 2.0;
  const Capacity capacity{0, 12};
  const std::string memory =
      test::setup_error([&] { static_cast<void>(Detector::plan(config, capacity)); });
  for (const char* name : {"candidates: ", "vmin", "places: "})
    EXPECT_TRUE(test::says(memory, name));
  EXPECT_EQ(test::setup_error([&] { static_cast<void>(Detector::most_work(config, capacity)); }),
            memory);
}

TEST(Detector, RefusesToBelieveByFewerRowsThanShowTheScene) {
  MatcherConfig config;
  PlaceMap map({}, {50, 3});
  EXPECT_TRUE(map.add(std::vector<float>{1.0F, 0.0F, 0.0F}));
  config.relocalising.rows_scanned = 19;
  EXPECT_THROW(Detector(config, map), SetupError);
  config.relocalising.rows_scanned = 20;
  EXPECT_NO_THROW(Detector(config, map));
}

TEST(Detector, RefusesAMapThatDoesNotFitItsUse) {
  MatcherConfig config = paper(Candidates::all, 5);
  const oracle::Vectors drive = oracle::drive(1, 30, 9);
  PlaceMap raw = map_of(drive, config);
  MatcherConfig other = config;
  other.standardisation.on = true;
  PlaceMap standardised = map_of(drive, other);
  EXPECT_THROW(Detector(config, standardised), SetupError);
  EXPECT_THROW(Detector(other, raw), SetupError);
  other.use = Use::close_loops;
  EXPECT_THROW(Detector(other, raw), SetupError);
  // Made for a drive that closes loops, it leaves standardising to the detector.
  PlaceMap filled(other, {30, 9});
  for (const auto& place : drive) ASSERT_TRUE(filled.add(place));
  for (const Use use : {Use::localise, Use::close_loops}) {
    other.use = use;
    EXPECT_TRUE(test::says(test::setup_error([&] { const Detector none(other, filled); }),
                           "its places are not standardised"));
  }
  other = config;
  other.arithmetic = Arithmetic::int8;
  EXPECT_THROW(Detector(other, raw), SetupError);
  PlaceMap empty(config, {3, 9});
  EXPECT_TRUE(test::says(test::setup_error([&] { const Detector none(config, empty); }),
                         "or let it close loops (close_loops)"));
}

TEST(Detector, NeedsNoRowsToScanWhereNoneAreScanned) {
  MatcherConfig config = paper(Candidates::all, 20, Use::localise);
  config.relocalising = {.on = false, .rows_scanned = 0};
  ASSERT_TRUE(validate(config).empty());
  const oracle::Vectors places = oracle::drive(3, 60, 12);
  const std::vector<FrameReport> found = reports(places, places, config);
  EXPECT_EQ(found.back().match->place, 49U);
}

TEST(Detector, TakesAMapThatStandardisesWithoutHavingLearntTheDrive) {
  MatcherConfig config = paper(Candidates::all, 5);
  config.standardisation.on = true;
  const oracle::Vectors drive = oracle::drive(1, 30, 9);
  PlaceMap map(config, {drive.size(), drive.front().size()});
  for (const auto& place : drive) ASSERT_TRUE(map.add(place));
  Detector detector(config, map);
  std::size_t own_place = 0;
  for (const auto& frame : drive) {
    for (const Answer& answer : detector.step(frame).answers) {
      own_place += answer.match && answer.match->place == answer.frame ? 1U : 0U;
    }
  }
  EXPECT_EQ(own_place, drive.size() - config.sequence_length);
}

TEST(Validate, TakesTheEdgesAndRefusesWhatLiesBeyond) {
  const auto faults = [](auto change) {
    MatcherConfig config;
    change(config);
    return validate(config).size();
  };
  EXPECT_EQ(faults([](MatcherConfig&) {}), 0U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.sequence_length = 1; }), 0U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.sequence_length = 2000; }), 0U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.sequence_length = 2001; }), 1U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.vmin = c.vmax = 1.0; }), 0U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.vmin = -0.1; }), 1U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.vmax = std::nan(""); }), 1U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.vmin = 1.01, c.vmax = 1.02; }), 1U);
  EXPECT_EQ(faults([](MatcherConfig& c) { c.relocalising.distances = 1'000'000'000; }), 0U);
  EXPECT_EQ(faults([](MatcherConfig& c) {
              c.relocalising.distances = std::numeric_limits<std::size_t>::max();
            }),
            1U);
  const MatcherConfig exact = paper(Candidates::all, 20);
  constexpr std::size_t most_places = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(validate(Capacity{0, 0}, exact).size(), 2U);
  EXPECT_EQ(validate(Capacity{most_places, std::size_t{1} << 22U}, exact).size(), 0U);
  EXPECT_EQ(validate(Capacity{1, most_small_values}, {}).size(), 0U);
  EXPECT_EQ(validate(Capacity{1, most_small_values + 1}, {}).size(), 1U);
}

TEST(Validate, WhatIsJustBeyondALimitIsNotToldAsTheLimit) {
  MatcherConfig config;
  config.min_probability = std::nextafter(1.0F, 2.0F);
  config.vmin = -1e-9;
  config.vmax = 1e300;
  const std::string message = test::setup_error([&] { check(config, {1, 1}); });
  EXPECT_TRUE(test::says(message, "min_probability: 1.0000001 is not above 0 and at most 1"));
  EXPECT_TRUE(test::says(message, "vmin: -1e-09 is not between 0 and 10"));
  EXPECT_TRUE(test::says(message, "vmax: 1e+300 is not between 0 and 10"));
}

TEST(Validate, RefusesAChoiceThatIsNone) {
  MatcherConfig config;
  config.candidates = Candidates{77};
  config.difference = Difference{77};
  config.arithmetic = Arithmetic{3};
  config.use = Use{2};
  config.full_map = FullMap{3};
  config.decision = Decision{255};
  const std::string message = test::setup_error([&] { check(config, {1, 1}); });
  EXPECT_TRUE(test::says(message, "candidates: 77 is none of its values, 0 to 2; take one"));
  EXPECT_TRUE(test::says(message, "difference: 77 is none of its values, 0 to 1"));
  EXPECT_TRUE(test::says(message, "arithmetic: 3 is none of its values, 0 to 2"));
  EXPECT_TRUE(test::says(message, "use: 2 is none of its values, 0 to 1"));
  EXPECT_TRUE(test::says(message, "full_map: 3 is none of its values, 0 to 2"));
  EXPECT_TRUE(test::says(message, "decision: 255 is none of its values, 0 to 1"));
  EXPECT_EQ(std::ranges::count(message, '\n'), 5) << "one fault each: " << message;
}

TEST(Validate, LongDescriptorsFitOnceAllIsDoneThatTheFaultAsksFor) {
  const Capacity capacity{1, most_small_values + 1};
  MatcherConfig config;
  const auto remedy = [&] { return to_string(validate(capacity, config).at(0)); };
  EXPECT_TRUE(test::says(remedy(), "arithmetic to float32"));
  config.arithmetic = Arithmetic::float32;
  EXPECT_TRUE(test::says(remedy(), "relocalising.on to false"));
  config.relocalising.on = false;
  EXPECT_TRUE(test::says(remedy(), "decision to uniqueness"));
  config.decision = Decision::uniqueness;
  EXPECT_EQ(validate(capacity, config).size(), 0U);
}

TEST(Detector, SaysOfAMapWhatElseMakesItAnother) {
  MatcherConfig config;
  config.candidates = Candidates::all;
  config.decision = Decision::uniqueness;
  PlaceMap map(config, {10, 3});
  ASSERT_TRUE(map.add(std::vector<float>{1.0F, 0.0F, 0.0F}));
  const std::string message = test::setup_error([&] { const Detector detector({}, map); });
  EXPECT_TRUE(test::says(message, "candidates"));
  EXPECT_TRUE(test::says(message, "decision"));
}

}  // namespace
}  // namespace seqloop
