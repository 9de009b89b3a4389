// SPDX-License-Identifier: MIT
// Evidence over time: every frame is answered once, surely where it is known, and not where not.
#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "core/matcher.hpp"
#include "core/seen.hpp"
#include "core/ways.hpp"
#include "seqloop/detail/calibration.hpp"
#include "seqloop/detail/evidence.hpp"

namespace seqloop {
namespace {

using test::unit;
using test::way;

constexpr std::size_t size = 256;

MatcherConfig settings(Use use) {
  MatcherConfig config;
  config.use = use;
  config.standardisation.on = false;
  return config;
}

/// Steps whose answers are not asked for.
void take(Detector& detector, std::span<const std::vector<float>> frames) {
  for (const auto& descriptor : frames) static_cast<void>(detector.step(descriptor));
}

struct Said {
  std::vector<Answer> answers;
  std::vector<FrameReport> reports;
  Work most;
};

Said drive_with(Detector& detector, const oracle::Vectors& query, bool finish = true) {
  Said said;
  for (const auto& descriptor : query) {
    const FrameReport report = detector.step(descriptor);
    said.answers.insert(said.answers.end(), report.answers.begin(), report.answers.end());
    EXPECT_TRUE(std::ranges::is_sorted(report.answers, {}, &Answer::frame));
    said.most.sketches = std::max(said.most.sketches, report.work.sketches);
    said.most.scanned = std::max(said.most.scanned, report.work.scanned);
    said.reports.push_back(report);
  }
  if (finish) {
    const auto rest = detector.finish();
    said.answers.insert(said.answers.end(), rest.begin(), rest.end());
  }
  std::ranges::sort(said.answers, {}, &Answer::frame);
  return said;
}

Said drive_through(const oracle::Vectors& reference, const oracle::Vectors& query,
                   const MatcherConfig& config, bool finish = true) {
  PlaceMap map = reference.empty() ? PlaceMap(config, {query.size(), query.front().size()})
                                   : map_of(reference, config);
  Detector detector(config, map);
  return drive_with(detector, query, finish);
}

void expect_each_frame_once(const Said& said, std::size_t frames) {
  ASSERT_EQ(said.answers.size(), frames);
  for (std::size_t i = 0; i < frames; ++i) {
    EXPECT_EQ(said.answers[i].frame, i);
    EXPECT_GE(said.answers[i].probability, 0.0F);
    EXPECT_LE(said.answers[i].probability, 1.0F);
  }
}

std::size_t accepted(const Said& said) {
  return static_cast<std::size_t>(std::ranges::count(said.answers, Gate::match, &Answer::gate));
}

/// Every n-th frame of a way from a first one on, n being `by`.
oracle::Vectors thinned(const oracle::Vectors& way, double by, double first = 0.0) {
  oracle::Vectors some;
  for (double i = first; i < static_cast<double>(way.size()); i += by) {
    some.push_back(way[static_cast<std::size_t>(i)]);
  }
  return some;
}

TEST(PlaceBelief, KnowsWhereItIsAtAnotherPaceThanTheReference) {
  constexpr float noise = 5.0F;
  for (const double pace : {0.5, 0.7, 1.5}) {
    SCOPED_TRACE(pace);
    const oracle::Vectors reference = thinned(way(1, 300, noise, 1), std::max(1.0, 1.0 / pace));
    const oracle::Vectors query = thinned(way(1, 300, noise, 2), std::max(1.0, pace));
    const Said said = drive_through(reference, query, settings(Use::localise));
    EXPECT_GE(accepted(said), query.size() * 9 / 10) << accepted(said);
    for (const Answer& answer : said.answers) {
      if (answer.gate != Gate::match) continue;
      EXPECT_NEAR(static_cast<double>(answer.match->place),
                  pace * static_cast<double>(answer.frame), 12.0);
    }
  }
}

/// A robot that adds its drive to a map of an earlier one, which it passes more slowly.
TEST(PlaceBelief, RecognisesAnEarlierDriveThatItPassesMoreSlowly) {
  constexpr float noise = 5.0F;
  constexpr std::size_t frames = 300;
  std::size_t found = 0;
  std::size_t all = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const MatcherConfig config = settings(Use::close_loops);
    const oracle::Vectors before = thinned(way(seed, frames, noise, 1), 2.0);
    const oracle::Vectors query = way(seed, frames, noise, 2);
    PlaceMap map(config, {before.size() + query.size(), size, 2});
    ASSERT_TRUE(map.begin_session());
    for (const auto& place : before) ASSERT_TRUE(map.add(place));
    Detector detector(config, map);
    for (const Answer& answer : drive_with(detector, query).answers) {
      if (answer.gate != Gate::match) continue;
      ++found;
      EXPECT_NEAR(static_cast<double>(answer.match->place), static_cast<double>(answer.frame) / 2.0,
                  12.0);
    }
    all += query.size();
  }
  std::printf("%zu of %zu frames\n", found, all);
  EXPECT_GE(found, all * 7 / 10);
}

/// Drives that pass a way, another one, and the first again.
TEST(PlaceBelief, ClosesLoopsAtAnotherPaceThanBefore) {
  constexpr float noise = 4.0F;
  for (const auto& [pace, least] : {std::pair{0.5, 0.9}, {0.7, 0.9}, {1.5, 0.9}, {1.8, 0.6}}) {
    SCOPED_TRACE(pace);
    std::size_t found = 0;
    std::size_t all = 0;
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
      const oracle::Vectors before = thinned(way(seed, 300, noise, 1), std::max(1.0, 1.0 / pace));
      const oracle::Vectors elsewhere = way(seed + 50, 100, noise, 1);
      const oracle::Vectors again = thinned(way(seed, 300, noise, 2), std::max(1.0, pace));
      oracle::Vectors drive = before;
      drive.insert(drive.end(), elsewhere.begin(), elsewhere.end());
      const auto begins = static_cast<double>(drive.size());
      drive.insert(drive.end(), again.begin(), again.end());
      for (const Answer& answer : drive_through({}, drive, settings(Use::close_loops)).answers) {
        if (answer.gate != Gate::match) continue;
        ++found;
        EXPECT_NEAR(static_cast<double>(answer.match->place),
                    pace * (static_cast<double>(answer.frame) - begins), 12.0);
      }
      all += again.size();
    }
    std::printf("at %.1f times the pace %zu of %zu frames\n", pace, found, all);
    EXPECT_GE(static_cast<double>(found), least * static_cast<double>(all));
  }
}

/// No line of .8 rows a frame and more knows where on such a map a robot is.
TEST(PlaceBelief, NamesThePlaceInAMapOfEveryFifthOrEighth) {
  for (const double step : {5.0, 8.0}) {
    for (const float noise : {0.5F, 2.0F}) {
      std::size_t found = 0;
      std::size_t off = 0;
      for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        const oracle::Vectors map = thinned(way(seed, 800, noise, 1), step);
        const oracle::Vectors query = way(seed, 800, noise, 2);
        for (const Answer& answer : drive_through(map, query, settings(Use::localise)).answers) {
          if (answer.gate != Gate::match) continue;
          ++found;
          const double is = static_cast<double>(answer.frame) / step;
          if (std::abs(static_cast<double>(answer.match->place) - is) > 1.5) ++off;
        }
      }
      std::printf("every %.0fth, noise %.1f: %zu found, %zu of them off\n", step,
                  static_cast<double>(noise), found, off);
      EXPECT_GT(found, 4700U);
      EXPECT_LT(off, found / 50);
    }
  }
}

/// Frames far from each other, taken half way between those of the map: they gain little, though
/// they are right.
TEST(PlaceBelief, FindsFramesThatWereTakenBetweenThoseOfTheMap) {
  struct Case {
    float noise;
    double least_localised;
    double least_in_loops;
  };
  constexpr std::size_t frames = 400;
  for (const auto& [noise, least_localised, least_in_loops] :
       {Case{2.5F, 0.95, 0.93}, Case{3.0F, 0.37, 0.3}}) {
    SCOPED_TRACE(noise);
    std::size_t localised = 0;
    std::size_t in_loops = 0;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      constexpr float kept = 0.5F;
      const oracle::Vectors map = thinned(way(seed, 2 * frames, noise, 1, size, kept), 2.0);
      const oracle::Vectors query = thinned(way(seed, 2 * frames, noise, 2, size, kept), 2.0, 1.0);
      oracle::Vectors both = map;
      both.insert(both.end(), query.begin(), query.end());
      const auto count = [](const Said& said, std::size_t begins, std::size_t& found) {
        for (const Answer& answer : said.answers) {
          if (answer.gate != Gate::match) continue;
          ++found;
          EXPECT_NEAR(static_cast<double>(answer.match->place),
                      static_cast<double>(answer.frame) - static_cast<double>(begins), 10.0);
        }
      };
      count(drive_through(map, query, settings(Use::localise)), 0, localised);
      count(drive_through({}, both, settings(Use::close_loops)), frames, in_loops);
    }
    constexpr std::size_t all = 6 * frames;
    std::printf("localised %zu, in loops %zu of %zu frames\n", localised, in_loops, all);
    EXPECT_GE(static_cast<double>(localised), least_localised * static_cast<double>(all));
    EXPECT_GE(static_cast<double>(in_loops), least_in_loops * static_cast<double>(all));
  }
}

TEST(PlaceBelief, KnowsWhereItIsOnAKnownWayEdgesIncluded) {
  const oracle::Vectors reference = way(1, 300, 0.5F, 1);
  const oracle::Vectors query = way(1, 300, 0.5F, 2);
  const Said said = drive_through(reference, query, settings(Use::localise));
  expect_each_frame_once(said, 300);
  EXPECT_GT(accepted(said), 270U);
  for (const Answer& answer : said.answers) {
    if (answer.gate != Gate::match) continue;
    EXPECT_NEAR(static_cast<double>(answer.match->place), static_cast<double>(answer.frame), 2.0);
  }
  EXPECT_EQ(said.answers.back().gate, Gate::match) << "the end of a drive";
  EXPECT_GT(said.reports.back().now->probability, 0.99F);
}

TEST(PlaceBelief, InventsNothingWhereNoPlaceComesTwice) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    EXPECT_EQ(accepted(drive_through({}, way(seed, 500, 0.5F, 1), settings(Use::close_loops))), 0U);
    const Said elsewhere = drive_through(way(seed, 400, 0.5F, 1), way(seed + 50, 400, 0.5F, 1),
                                         settings(Use::localise));
    EXPECT_EQ(accepted(elsewhere), 0U);
    EXPECT_GT(std::ranges::count(elsewhere.answers, Gate::new_place, &Answer::gate), 350);
  }
}

/// 400 frames, 100 of them again, and then another road.
/// @param old part of its first view that is still that along the old one, less over 100 frames
oracle::Vectors leaving(std::uint32_t seed, float noise, float old) {
  const oracle::Vectors again = way(seed, 350, noise, 2);
  const oracle::Vectors other = way(seed + 50, 150, noise, 1);
  oracle::Vectors drive = way(seed, 400, noise, 1);
  drive.insert(drive.end(), again.begin() + 100, again.begin() + 200);
  for (std::size_t i = 0; i < other.size(); ++i) {
    const float part = old * std::max(0.0F, 1.0F - static_cast<float>(i) / 100.0F);
    drive.push_back(other[i]);
    for (std::size_t d = 0; d < size; ++d) {
      drive.back()[d] += part * (again[200 + i][d] - other[i][d]);
    }
  }
  return unit(drive);
}

/// A revisit, and then another road, whose view is at first a little of that along the old one.
TEST(PlaceBelief, AnswersARevisitToItsEndAndNotMuchFurther) {
  constexpr float noise = 4.0F;
  constexpr std::size_t comes = 400;
  constexpr std::size_t leaves = 500;
  std::size_t before = 0;
  std::size_t last = 0;    // of the last 20 frames
  std::size_t behind = 0;  // later than 20 frames after it
  std::size_t doubted = 0;
  const auto hardly_sure = static_cast<float>(calibrated(0.7));
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    for (const Answer& answer :
         drive_through({}, leaving(seed, noise, 0.3F), settings(Use::close_loops)).answers) {
      // Frames at its ends that hardly lie on the trace are as likely right as wrong.
      if (answer.probability > 0.45F && answer.probability < 0.99F) {
        ++doubted;
        EXPECT_LE(answer.probability, hardly_sure) << answer.frame;
        EXPECT_EQ(answer.gate, Gate::unsure) << answer.frame;
      }
      if (answer.gate != Gate::match) continue;
      before += static_cast<std::size_t>(answer.frame < comes);
      last += static_cast<std::size_t>(answer.frame + 20 >= leaves && answer.frame < leaves);
      behind += static_cast<std::size_t>(answer.frame >= leaves + 20);
    }
  }
  EXPECT_LE(before, 16U);
  EXPECT_EQ(last, 6U * 20U);
  // The old view fades over 100 frames: two of the six drives are taken to go on along it for 50.
  EXPECT_LE(behind, 50U);
  EXPECT_GT(doubted, 0U);
}

/// Drives that leave a known road for one beside it, which looks a little like it, and come back
/// onto it as far on as if they had never left.
TEST(PlaceBelief, KnowsThatARevisitWasInterrupted) {
  constexpr float noise = 4.0F;
  constexpr std::size_t comes = 400;
  constexpr std::size_t leaves = 80;  // frames after it comes
  constexpr std::size_t returns = 140;
  std::size_t beside = 0;
  std::size_t known = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    oracle::Vectors again = way(seed, 350, noise, 2);
    const oracle::Vectors other = way(seed + 50, 350, noise, 1);
    for (std::size_t i = leaves; i < returns; ++i) {
      for (std::size_t d = 0; d < size; ++d) {
        constexpr float alike = 0.07F;
        again[100 + i][d] = other[i][d] + alike * (again[100 + i][d] - other[i][d]);
      }
    }
    oracle::Vectors drive = way(seed, 400, noise, 1);
    drive.insert(drive.end(), again.begin() + 100, again.begin() + 330);
    for (const Answer& answer :
         drive_through({}, unit(drive), settings(Use::close_loops)).answers) {
      if (answer.gate != Gate::match) continue;
      const auto frame = static_cast<std::size_t>(answer.frame);
      const std::size_t since = frame - std::min(frame, std::size_t{comes});
      // Where roads part and meet they show the same.
      constexpr std::size_t near = 10;
      const bool is_beside = since >= leaves + near && since + near < returns;
      const bool is_known = since < leaves || since >= returns;
      beside += static_cast<std::size_t>(is_beside);
      known += static_cast<std::size_t>(is_known);
    }
  }
  EXPECT_EQ(beside, 0U);
  // As it leaves, the doubt rises, and the frames before that are in doubt, too.
  EXPECT_GE(known, 870U) << "of 1,020";
}

/// A revisit, and from one frame to the next another road that nothing is known of.
TEST(PlaceBelief, IsNotOnARoadThatItHasLeftAtOnce) {
  constexpr float noise = 2.0F;
  constexpr std::uint64_t leaves = 500;
  std::size_t on = 0;
  std::size_t behind = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    for (const Answer& answer :
         drive_through({}, leaving(seed, noise, 0.0F), settings(Use::close_loops)).answers) {
      if (answer.gate != Gate::match) continue;
      ++(answer.frame < leaves ? on : behind);
    }
  }
  EXPECT_GE(on, 12U * 90U);
  EXPECT_LE(behind, 12U) << "one a drive";
}

void expect_found_lap_after_lap(std::uint32_t frames) {
  oracle::Vectors laps;
  for (std::uint32_t lap = 0; lap < 6; ++lap) {
    const oracle::Vectors more = way(3, frames, 0.5F, lap);
    laps.insert(laps.end(), more.begin(), more.end());
  }
  const Said said = drive_through({}, laps, settings(Use::close_loops));
  expect_each_frame_once(said, laps.size());
  for (std::size_t lap = 0; lap < 6; ++lap) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < frames; ++i) {
      const Answer& answer = said.answers[lap * frames + i];
      if (answer.gate != Gate::match) continue;
      ++found;
      const auto off = static_cast<int>(answer.match->place % frames) - static_cast<int>(i);
      EXPECT_LE(std::abs(off), 2) << "lap " << lap << ", frame " << i;
    }
    EXPECT_TRUE(lap == 0 ? found == 0 : found > frames - 20) << "lap " << lap << ": " << found;
  }
}

TEST(PlaceBelief, ClosesLoopsLapAfterLapNoWorseInTheEnd) { expect_found_lap_after_lap(200); }

TEST(PlaceBelief, ClosesLoopsOnShortLaps) { expect_found_lap_after_lap(90); }

/// A wiper on the lens, say, that comes by again and again while nothing else does.
TEST(PlaceBelief, WhatComesAgainAndAgainIsNoLap) {
  std::size_t accepted = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    for (const std::size_t period : {30U, 40U, 60U}) {
      oracle::Vectors drive = way(seed, 500, 0.3F, 1);
      const oracle::Vectors wiper = way(seed + 70, period, 0.3F, 1, size, 0.0F);
      for (std::size_t i = 0; i < drive.size(); ++i) {
        for (std::size_t d = 0; d < size; ++d) drive[i][d] += 0.4F * wiper[i % period][d];
      }
      for (const Answer& answer :
           drive_through({}, unit(drive), settings(Use::close_loops)).answers) {
        accepted += answer.gate == Gate::match ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(accepted, 0U) << "of 9,000";
}

TEST(PlaceBelief, ARobotThatStandsGainsNothing) {
  const oracle::Vectors places = way(4, 300, 0.5F, 1);
  oracle::Vectors query = way(5, 30, 0.5F, 1);
  std::mt19937 random(6);
  const std::vector<float> last = query.back();
  for (int i = 0; i < 2000; ++i) {
    query.push_back(last);
    for (float& value : query.back()) {
      value += 0.002F * (static_cast<float>(random()) / 4294967296.0F - 0.5F);
    }
  }
  EXPECT_EQ(accepted(drive_through(places, unit(query), settings(Use::localise))), 0U);
  EXPECT_EQ(accepted(drive_through({}, unit(query), settings(Use::close_loops))), 0U);
}

TEST(PlaceBelief, ACarriedRobotLosesItsBeliefAndFindsItself) {
  const oracle::Vectors reference = way(7, 2000, 0.5F, 1);
  const oracle::Vectors same = way(7, 2000, 0.5F, 2);
  oracle::Vectors query;
  std::vector<std::size_t> truth;
  std::mt19937 random(8);
  for (int jump = 0; jump < 40; ++jump) {
    const std::size_t start = random() % 1900;
    for (std::size_t i = 0; i < 60; ++i) {
      query.push_back(same[start + i]);
      truth.push_back(start + i);
    }
  }
  const Said said = drive_through(reference, query, settings(Use::localise));
  expect_each_frame_once(said, query.size());
  std::size_t wrong = 0;
  for (const Answer& answer : said.answers) {
    if (answer.gate != Gate::match) continue;
    const std::size_t there = truth[static_cast<std::size_t>(answer.frame)];
    const auto off = static_cast<int>(answer.match->place) - static_cast<int>(there);
    if (std::abs(off) > 10) ++wrong;
  }
  std::printf("%zu accepted of %zu, %zu wrong\n", accepted(said), query.size(), wrong);
  EXPECT_LE(wrong, 1U) << "after one of 40 jumps the row before it lives on for a frame";
  EXPECT_GT(accepted(said), query.size() * 7 / 10);
  std::size_t sure = 0;
  std::size_t mistaken = 0;
  for (const FrameReport& report : said.reports) {
    if (!report.now || report.now->probability < 0.99F) continue;
    ++sure;
    const std::size_t there = truth[static_cast<std::size_t>(report.newest)];
    const auto off = static_cast<int>(report.now->place) - static_cast<int>(there);
    if (std::abs(off) > 10) ++mistaken;
  }
  std::printf("sure of %zu newest frames, mistaken in %zu\n", sure, mistaken);
  EXPECT_GT(sure, query.size() / 10);
  EXPECT_LE(mistaken, sure / 100) << "what is said of the newest frame ends with the jump";
}

TEST(PlaceBelief, SaysOfTheNewestFrameHowOftenSuchWasRight) {
  const oracle::Vectors reference = way(1, 200, 5.0F, 1);
  PlaceMap map = map_of(reference, settings(Use::localise));
  Detector detector(settings(Use::localise), map);
  std::size_t unsure = 0;
  for (const auto& descriptor : way(1, 200, 5.0F, 2)) {
    const FrameReport report = detector.step(descriptor);
    if (!report.now) continue;
    const double odds = log_odds_now(*detector.evidence());
    ASSERT_EQ(report.now->probability, static_cast<float>(calibrated_now(odds)));
    unsure += static_cast<std::size_t>(report.now->probability > 0.1F && odds < 0.0);
  }
  EXPECT_GT(unsure, 0U) << "of which the log-odds by themselves say too little";
}

/// That a robot is carried about speaks for the map while it is found there again and again: not
/// when it has not been found for long, and not in another drive.
TEST(PlaceBelief, JumpsSpeakForTheMapUntilTheRobotHasLeftIt) {
  const oracle::Vectors same = way(7, 400, 0.5F, 2);
  const MatcherConfig config = settings(Use::localise);
  PlaceMap map = map_of(way(7, 400, 0.5F, 1), config);
  Detector detector(config, map);
  const auto speaks_after = [&](std::span<const std::vector<float>> frames) {
    take(detector, frames);
    return detector.evidence() ? detector.evidence()->jumps : -1.0;
  };
  const auto carry_about = [&] {
    for (const std::size_t first : {20U, 220U, 120U}) {
      static_cast<void>(speaks_after(std::span(same).subspan(first, 60)));
    }
    return speaks_after(std::span(same).subspan(320, 60));
  };
  EXPECT_EQ(speaks_after(std::span(same).subspan(100, 60)), 0.0);
  EXPECT_GT(carry_about(), 0.02);
  // Frames from before a gap are answered after it.
  detector.skip(100);
  EXPECT_EQ(speaks_after(std::span(same).subspan(100, 20)), 0.0) << "not found since a gap";
  EXPECT_GT(speaks_after(std::span(same).subspan(120, 60)), 0.02);
  static_cast<void>(detector.finish());
  EXPECT_EQ(speaks_after(std::span(same).subspan(100, 60)), 0.0) << "another drive";
  EXPECT_GT(carry_about(), 0.02);
  const oracle::Vectors elsewhere = way(9, 110, 0.5F, 1);
  EXPECT_GT(speaks_after(std::span(elsewhere).first(40)), 0.02) << "it may come back";
  EXPECT_EQ(speaks_after(std::span(elsewhere).subspan(40)), 0.0)
      << "it was not found for 100 frames";
}

/// Steps until the answer of a frame is accepted that is not before this one; all, if none is.
std::size_t steps_until_found(Detector& detector, std::span<const std::vector<float>> frames,
                              std::uint64_t from) {
  std::size_t steps = 0;
  for (const auto& descriptor : frames) {
    ++steps;
    for (const Answer& answer : detector.step(descriptor).answers) {
      if (answer.gate == Gate::match && answer.frame >= from) return steps;
    }
  }
  return steps;
}

/// Steps that ten robots take until they are found again in an earlier drive, after so many frames
/// elsewhere.
std::size_t found_again_after(std::size_t away, Use use) {
  std::size_t steps = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const MatcherConfig config = settings(use);
    PlaceMap map(config, {1200, size, 2});
    EXPECT_TRUE(map.begin_session());
    fill(map, way(seed, 400, 4.0F, 1));
    Detector detector(config, map);
    const oracle::Vectors same = way(seed, 400, 4.0F, 2);
    take(detector, std::span(same).first(100));
    take(detector, way(seed + 100, away, 4.0F, 1));
    steps += steps_until_found(detector, std::span(same).subspan(200), 100 + away);
  }
  return steps;
}

/// Much looks alike: a robot that was not found lately has to be seen better before it is.
TEST(PlaceBelief, MoreIsAskedWhereTheRobotWasNotFoundLately) {
  const std::size_t soon = found_again_after(80, Use::localise);
  const std::size_t later = found_again_after(140, Use::localise);
  const std::size_t late = found_again_after(200, Use::localise);
  std::printf("found again after %zu, %zu and %zu frames of ten drives\n", soon, later, late);
  EXPECT_GT(later, soon + 20);
  EXPECT_GT(late, later + 20);
  EXPECT_GT(late, soon + 60);
  EXPECT_LT(late, soon + 150);
}

TEST(PlaceBelief, MoreIsAskedOfADriveThatIsAddedToo) {
  const std::size_t soon = found_again_after(80, Use::close_loops);
  const std::size_t late = found_again_after(300, Use::close_loops);
  std::printf("found again after %zu and %zu frames of ten drives\n", soon, late);
  EXPECT_GT(late, soon + 20);
}

/// Closes the loops of its own drive. Counts below are of so many newest frames that are no places.
struct Robot {
  MatcherConfig config = [] {
    MatcherConfig closing = settings(Use::close_loops);
    closing.exclude = 60;
    return closing;
  }();
  PlaceMap map{config, {1200, size}};
  Detector detector{config, map};
};

/// Many drives never come back to where they were: one that has will again.
TEST(PlaceBelief, ADrivesFirstLoopHasToBeSeenBetterThanItsOthers) {
  std::size_t first = 0;
  std::size_t later = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Robot robot;
    Detector& detector = robot.detector;
    take(detector, way(seed, 400, 4.0F, 1));
    const oracle::Vectors same = way(seed, 400, 4.0F, 2);
    const std::size_t steps = steps_until_found(detector, std::span(same).subspan(100), 400);
    take(detector, way(seed + 100, 300, 4.0F, 1));
    first += steps;
    later += steps_until_found(detector, std::span(same).subspan(250), 700 + steps);
  }
  std::printf("found after %zu and %zu frames of ten drives\n", first, later);
  EXPECT_GT(first, later + 20);
  EXPECT_LT(first, later + 120);
}

/// A visit is linked to its place if it is sure but for what is asked of a first loop. Otherwise
/// the next ones would have two places to be at, then three, and none would be sure.
TEST(PlaceBelief, LinksAVisitThatIsNotSureEnoughToBeAccepted) {
  std::size_t unsure_but_linked = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Robot robot;
    take(robot.detector, way(seed, 300, 4.0F, 1));
    std::size_t accepted = 0;
    const auto count = [&](std::span<const Answer> answers) {
      accepted += static_cast<std::size_t>(std::ranges::count(answers, Gate::match, &Answer::gate));
    };
    const oracle::Vectors again = way(seed, 300, 4.0F, 2);
    for (std::size_t i = 100; i < 140; ++i) count(robot.detector.step(again[i]).answers);
    count(robot.detector.finish());
    std::size_t linked = 0;
    for (std::size_t row = 300; row < robot.map.size(); ++row) {
      const std::uint64_t first = robot.map.first_visit(row);
      if (first == row) continue;
      ++linked;
      EXPECT_NEAR(static_cast<double>(first), static_cast<double>(row) - 200.0, 10.0) << row;
    }
    unsure_but_linked += static_cast<std::size_t>(accepted == 0 && linked > 35);
  }
  std::printf("linked though unsure: %zu of ten revisits\n", unsure_but_linked);
  EXPECT_GE(unsure_but_linked, 3U);
}

/// Section 6.6, number by number.
TEST(PlaceBelief, AsksMuchOfAFirstLoopAndALittleOfOthers) {
  Robot robot;
  Detector& detector = robot.detector;
  const oracle::Vectors same = way(1, 400, 0.5F, 2);
  take(detector, way(1, 400, 0.5F, 1));
  ASSERT_TRUE(detector.evidence());
  EXPECT_EQ(detector.evidence()->asked, 2.2);
  const std::size_t steps = steps_until_found(detector, std::span(same).subspan(100), 400);
  EXPECT_LT(steps, 100U);
  EXPECT_EQ(detector.evidence()->asked, 2.2) << "it was asked before the answer was given";
  const auto rest = std::span(same).subspan(100 + steps);
  take(detector, rest.first(1));
  EXPECT_EQ(detector.evidence()->asked, 0.9);
  take(detector, way(2, 250, 0.5F, 1));
  EXPECT_EQ(detector.evidence()->asked, 0.9) << "however long ago that was";
  // The frames after a gap may be anywhere.
  detector.skip(robot.config.sequence_length + 1);
  take(detector, rest.first(5));
  EXPECT_EQ(detector.evidence()->asked, 2.2);
}

/// Of rows of another drive it depends on how long ago the robot was found.
TEST(PlaceBelief, AsksForMoreInAMapWhereTheRobotWasNotFoundLately) {
  const MatcherConfig config = settings(Use::localise);
  PlaceMap map = map_of(way(1, 400, 0.5F, 1), config);
  Detector detector(config, map);
  const oracle::Vectors same = way(1, 400, 0.5F, 2);
  take(detector, std::span(same).first(5));
  EXPECT_EQ(detector.evidence()->asked, 0.5);
  const std::size_t steps = steps_until_found(detector, std::span(same).subspan(5), 0);
  ASSERT_LT(steps, 100U);
  take(detector, std::span(same).subspan(5 + steps).first(100));
  EXPECT_EQ(detector.evidence()->asked, 0.0);
  take(detector, way(2, 350, 0.5F, 1));
  EXPECT_EQ(detector.evidence()->asked, 0.5);
}

/// A row that no single frame shows well is found sooner where the window's best line leads: by a
/// robot that was found lately, for any map has a best line.
TEST(PlaceBelief, IsBornWhereTheBestLineLeadsIfItWasFoundLately) {
  const auto found_after = [](std::size_t away) {
    std::size_t steps = 0;
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
      constexpr float noise = 5.0F;
      const MatcherConfig config = settings(Use::localise);
      PlaceMap map = map_of(way(seed, 1500, noise, 1), config);
      Detector detector(config, map);
      const oracle::Vectors same = way(seed, 1500, noise, 2);
      take(detector, std::span(same).first(100));
      take(detector, way(seed + 100, away, 0.5F, 1));
      bool found = false;
      for (std::size_t i = 800; i < 1000 && !found; ++i) {
        ++steps;
        const auto now = detector.step(same[i]).now;
        found = now && now->new_place < 0.5F &&
                std::abs(static_cast<double>(now->place) - static_cast<double>(i)) < 5.0;
      }
    }
    return steps;
  };
  const std::size_t lately = found_after(20);
  const std::size_t long_ago = found_after(250);
  std::printf("found again after %zu and %zu frames of twenty drives\n", lately, long_ago);
  EXPECT_LT(lately, 1250U);
  EXPECT_GT(long_ago, lately + 400);
}

/// The places of one session have changed from a point on, those of a later one are new until
/// shortly before it.
TEST(PlaceBelief, VisitsOfOnePlaceShareHowTheRobotCame) {
  constexpr std::size_t rows = 120;
  for (const bool one_place : {true, false}) {
    SCOPED_TRACE(one_place);
    oracle::Vectors places = way(1, rows, 0.3F, 1);
    std::ranges::copy(way(8, 60, 0.3F, 1), places.begin() + 60);
    oracle::Vectors later = way(1, rows, 0.3F, 2);
    std::ranges::copy(way(9, 45, 0.3F, 1), later.begin());
    places.insert(places.end(), later.begin(), later.end());
    const MatcherConfig config = settings(Use::localise);
    Seen seen(places, config, rows);
    for (std::size_t i = 0; one_place && i < rows; ++i) seen.map.link(rows + i, i);
    PlaceBelief belief(seen.memory.arena, config);
    constexpr double sure = 5.0;
    double best = 0.0;
    for (const auto& descriptor : way(1, 80, 0.3F, 3)) {
      static_cast<void>(belief.observe(seen.take(descriptor), 0.0));
      ASSERT_TRUE(belief.likeliest());
      const bool earlier = belief.likeliest()->row < rows;
      best = belief.remember(earlier ? sure : 0.0);
    }
    EXPECT_NEAR(static_cast<double>(belief.likeliest()->row), rows + 79.0, 2.0);
    std::vector<BeliefTraces::Step> trace(PlaceBelief::depth(config));
    trace.resize(belief.trace(belief.likeliest()->index, trace));
    EXPECT_EQ(trace.size() >= 75, one_place) << trace.size();
    EXPECT_EQ(best, one_place ? sure : 0.0);
  }
}

TEST(PlaceBelief, ACoveredLensSaysNothing) {
  const oracle::Vectors reference = way(9, 300, 0.5F, 1);
  oracle::Vectors query = way(9, 300, 0.5F, 2);
  const std::vector<float> blank(size);
  query.insert(query.begin() + 150, 1000, blank);
  const Said said = drive_through(reference, query, settings(Use::localise));
  expect_each_frame_once(said, query.size());
  for (std::size_t i = 150; i < 1150; ++i) EXPECT_EQ(said.answers[i].gate, Gate::frame_error);
  EXPECT_EQ(said.answers[100].gate, Gate::match);
  EXPECT_EQ(said.answers.back().gate, Gate::match);
}

/// The view that somebody hides who stands before the camera, at so many frames: they look alike,
/// and a little like what is behind.
oracle::Vectors hidden(std::span<const std::vector<float>> view, std::uint32_t seed) {
  const oracle::Vectors somebody = way(seed, 1, 1.0F, 1);
  oracle::Vectors seen(view.begin(), view.end());
  for (auto& descriptor : seen) {
    for (std::size_t i = 0; i < descriptor.size(); ++i) {
      descriptor[i] = 0.05F * descriptor[i] + somebody.front()[i];
    }
  }
  return test::unit(seen);
}

/// Whatever the frames between show, those after them are where the robot has come by then, or
/// where it has stood.
TEST(PlaceBelief, ARobotThatSeesNothingStandsOrDrivesOn) {
  constexpr std::uint32_t size_of_way = 200;
  constexpr std::size_t at = 100;
  constexpr float noise = 4.0F;
  for (const std::size_t unseen : {5U, 12U, 20U}) {
    for (const bool drives : {true, false}) {
      for (const bool covered : {true, false}) {
        SCOPED_TRACE(std::to_string(unseen) + (drives ? " drives" : " stands") +
                     (covered ? ", covered" : ", hidden"));
        std::size_t found = 0;
        std::size_t seen = 0;
        for (std::uint32_t seed = 1; seed <= 6; ++seed) {
          const oracle::Vectors map = way(seed, size_of_way, noise, 1);
          const oracle::Vectors drive = way(seed, size_of_way, noise, 2);
          oracle::Vectors query(drive.begin(), drive.begin() + at);
          const oracle::Vectors nothing =
              covered ? oracle::Vectors(unseen)
                      : hidden(std::span(drive).subspan(at, unseen), seed + 90);
          query.insert(query.end(), nothing.begin(), nothing.end());
          const std::size_t goes_on = drives ? at + unseen : at;
          query.insert(query.end(), drive.begin() + static_cast<std::ptrdiff_t>(goes_on),
                       drive.end());
          const std::size_t off = at + unseen - goes_on;
          MatcherConfig config = settings(Use::localise);
          config.standardisation.on = true;
          config.keyframes = true;
          for (const Answer& answer : drive_through(map, query, config).answers) {
            if (answer.frame >= at && answer.frame < at + unseen) continue;
            ++seen;
            if (answer.gate != Gate::match) continue;
            ++found;
            const std::uint64_t is = answer.frame < at ? answer.frame : answer.frame - off;
            EXPECT_NEAR(static_cast<double>(answer.match->place), static_cast<double>(is), 5.0);
          }
        }
        std::printf("%zu of %zu\n", found, seen);
        EXPECT_GE(found, seen * 9 / 10);
      }
    }
  }
}

TEST(PlaceBelief, ARobotThatStandsBehindALongCoverIsWhereItWas) {
  const oracle::Vectors reference = way(9, 120, 0.5F, 1);
  const oracle::Vectors query = way(9, 120, 0.5F, 2);
  const MatcherConfig config = settings(Use::localise);
  for (const auto& [at, covered] :
       {std::pair<std::size_t, std::size_t>{60, 40}, {60, 300}, {119, 40}}) {
    SCOPED_TRACE(std::to_string(at) + ", covered for " + std::to_string(covered));
    PlaceMap map = map_of(reference, config);
    Detector detector(config, map);
    take(detector, std::span(query).first(at + 1));
    take(detector, oracle::Vectors(covered));
    const auto now = detector.step(query[at]).now;
    ASSERT_TRUE(now);
    EXPECT_LT(now->new_place, 0.1F);
    EXPECT_NEAR(static_cast<double>(now->place), static_cast<double>(at), 20.0);
    const std::size_t goes_to = std::min(at + 15, query.size() - 1);
    take(detector, std::span(query).first(goes_to).subspan(at + 1 < query.size() ? at + 1 : at));
    const auto later = detector.step(query[goes_to]).now;
    ASSERT_TRUE(later);
    EXPECT_NEAR(static_cast<double>(later->place), static_cast<double>(goes_to), 5.0);
  }
}

TEST(PlaceBelief, AGapIsAGapInTimeAndNotInEvidence) {
  const oracle::Vectors reference = way(10, 400, 0.5F, 1);
  const oracle::Vectors query = way(10, 400, 0.5F, 2);
  const MatcherConfig config = settings(Use::localise);
  PlaceMap map = map_of(reference, config);
  Detector detector(config, map);
  std::size_t after_gaps = 0;
  std::size_t stepped = 0;
  std::size_t answered = 0;
  for (std::size_t i = 0; i < query.size(); ++i) {
    if (i >= 100 && i % 40 < 6) {
      detector.skip(1);
      continue;
    }
    const FrameReport report = detector.step(query[i]);
    ++stepped;
    answered += report.answers.size();
    if (i >= 100 && i % 40 == 7 && report.now && report.now->probability > 0.9F) {
      EXPECT_NEAR(static_cast<double>(report.now->place), static_cast<double>(i), 2.0);
      ++after_gaps;
    }
  }
  EXPECT_GE(after_gaps, 6U);
  // A long gap ends what belongs together: all that waits is answered with the next frame.
  detector.skip(1000);
  const FrameReport report = detector.step(query.front());
  answered += report.answers.size();
  EXPECT_EQ(answered, stepped) << "all but the newest";
}

TEST(PlaceBelief, PatienceMayBeNoneOrLong) {
  const oracle::Vectors reference = way(11, 150, 0.5F, 1);
  const oracle::Vectors query = way(11, 150, 0.5F, 2);
  for (const std::size_t patience : {0U, 1U, 9U, 10U, 11U, 300U, 1000U}) {
    MatcherConfig config = settings(Use::localise);
    config.patience = patience;
    const Said said = drive_through(reference, query, config);
    expect_each_frame_once(said, 150);
    EXPECT_GT(accepted(said), 50U) << patience;
    for (const FrameReport& report : said.reports) {
      EXPECT_LE(report.answers.size(), patience + 1);
    }
  }
}

// A row that is the query to the bit has a line of score 0.
TEST(PlaceBelief, TakesAScoreOfZeroForTheBest) {
  const oracle::Vectors drive = way(13, 300, 0.5F, 1);
  const Said said = drive_through(drive, drive, settings(Use::localise));
  expect_each_frame_once(said, drive.size());
  for (const Answer& answer : said.answers) {
    ASSERT_EQ(answer.gate, Gate::match) << answer.frame;
    EXPECT_EQ(answer.match->place, answer.frame);
  }
}

TEST(PlaceBelief, TakesNoneOfSeveralScoresOfZero) {
  const oracle::Vectors part = way(14, 75, 0.5F, 1);
  oracle::Vectors repeated;
  for (int i = 0; i < 4; ++i) repeated.insert(repeated.end(), part.begin(), part.end());
  EXPECT_EQ(accepted(drive_through(repeated, part, settings(Use::localise))), 0U);
}

TEST(PlaceBelief, TakesNoneOfTwoPlacesThatAreAlike) {
  // Nothing says somewhere new, and nothing says which of the two.
  const oracle::Vectors part = way(14, 150, 0.5F, 1);
  oracle::Vectors twice = part;
  twice.insert(twice.end(), part.begin(), part.end());
  for (const std::uint32_t noise : {1U, 2U, 3U}) {
    const Said said = drive_through(twice, way(14, 150, 0.5F, noise), settings(Use::localise));
    EXPECT_EQ(accepted(said), 0U) << noise;
  }
}

/// Answers that are accepted on a road beside another, and as that one comes again.
struct Beside {
  std::size_t wrong = 0;
  std::size_t right = 0;
};

/// A road, another beside it from which much of the same is to be seen, and the first one again.
/// What is seen from both, the share `seen` of it, has gone by after so many frames.
Beside accepted_beside(std::size_t frames, float seen) {
  Beside all;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const oracle::Vectors view = way(seed + 30, 60, 0.0F, 1);
    const auto road = [&](std::uint32_t own, std::uint32_t visit) {
      oracle::Vectors drive = way(own, 300, 1.0F, visit);
      for (std::size_t i = 0; i < drive.size(); ++i) {
        const std::size_t at = i / frames;
        const float gone = static_cast<float>(i % frames) / static_cast<float>(frames);
        for (std::size_t d = 0; d < size; ++d) {
          const float both = (1.0F - gone) * view[at][d] + gone * view[at + 1][d];
          drive[i][d] += seen / (1.0F - seen) * both;
        }
      }
      return unit(drive);
    };
    oracle::Vectors drive = road(seed, 1);
    const oracle::Vectors other = road(seed + 60, 1);
    const oracle::Vectors again = road(seed, 2);
    drive.insert(drive.end(), other.begin() + 100, other.begin() + 250);
    drive.insert(drive.end(), again.begin() + 20, again.begin() + 120);
    for (const Answer& answer : drive_through({}, drive, settings(Use::close_loops)).answers) {
      if (answer.gate == Gate::match) ++(answer.frame < 450 ? all.wrong : all.right);
    }
  }
  return all;
}

TEST(PlaceBelief, ARoadBesideLooksAlikeButChangesInItsOwnWay) {
  const Beside near = accepted_beside(6, 0.5F);
  const Beside far = accepted_beside(14, 0.6F);
  std::printf("near: %zu wrong, %zu of 600 right; far: %zu wrong, %zu right\n", near.wrong,
              near.right, far.wrong, far.right);
  EXPECT_EQ(near.wrong, 0U) << "440 if only the look counts";
  EXPECT_GT(near.right, 570U);
  EXPECT_EQ(far.wrong, 0U);
  EXPECT_GT(far.right, 570U) << "197 if only the look counts";
}

TEST(PlaceBelief, AShortTraceSufficesWhereNothingElseIsLeft) {
  // Followed for a dozen frames, and clearer than all else.
  Evidence e{.odds = 6.0, .known = 7.0, .lead = 2.0, .contrast = 1.3, .age = 1.3, .margin = 0.08};
  EXPECT_LT(log_odds_followed(e), 0.0);
  EXPECT_GT(log_odds(e), 3.5);
  EXPECT_DOUBLE_EQ(log_odds(e), log_odds_alone(e));
  // The newest frames speak against it.
  e.doubt = 2.0;
  EXPECT_LT(log_odds(e), 3.5);
  e.doubt = 0.0;
  // Another place is nearly as likely: then it has to be followed for longer.
  e.odds = 1.9;
  EXPECT_DOUBLE_EQ(log_odds(e), log_odds_followed(e));
  e.lead = 8.0;
  e.age = 3.5;
  EXPECT_GT(log_odds(e), 3.5);
}

TEST(PlaceBelief, LessSufficesTheOftenerTheRobotWasCarriedAboutOnTheMap) {
  Evidence e{.odds = 3.0, .known = 5.0, .lead = 4.0, .contrast = 0.5, .age = 2.0};
  const double never = log_odds(e);
  for (const auto& [jumps, more] : {std::pair{0.01, 0.1}, {0.15, 1.5}, {0.2, 2.0}, {0.5, 2.0}}) {
    e.jumps = jumps;
    EXPECT_NEAR(log_odds(e), never + more, 1e-12) << jumps;
  }
}

// Section 6.4, number by number.
TEST(PlaceBelief, WeighsEvidence) {
  Evidence e{.odds = 3.0,
             .known = 5.0,
             .lead = 4.0,
             .contrast = 0.5,
             .in_step = 0.05,
             .age = 2.0,
             .margin = 0.1,
             .doubt = 1.5};
  const double followed =
      -5.879 + 0.104 * 3.0 + 0.89 * 4.0 + 0.6 * 0.5 + 15.0 * 0.05 + 0.808 * 2.0 + 8.984 * 0.1;
  EXPECT_NEAR(log_odds_followed(e), followed, 1e-12);
  const double alone = -4.0 + 1.116 * 5.0 + 10.0 * 0.1 + 10.0 * 0.05 - 0.9 * 1.5;
  EXPECT_NEAR(log_odds_alone(e), alone, 1e-12);
  // What is asked besides speaks against the newest frame; answers take the best of many.
  e.asked = 0.7;
  EXPECT_NEAR(log_odds(e), std::max(followed, alone), 1e-12);
  EXPECT_NEAR(log_odds_now(e), std::max(followed, alone) - 0.7 - 6.0 * 1.5, 1e-12);
  // Where there is a rival, it may change as much.
  e.odds = 1.9;
  const double rivalled =
      -5.879 + 0.104 * 1.9 + 0.89 * 4.0 + 1.094 * 0.5 + 0.808 * 2.0 + 8.984 * 0.1;
  EXPECT_NEAR(log_odds_followed(e), rivalled, 1e-12);
}

TEST(PlaceBelief, NothingSpeaksForAFrameThatWasNotSeenOrADriveThatHasEnded) {
  const oracle::Vectors drive = way(15, 100, 0.5F, 1);
  const MatcherConfig config = settings(Use::localise);
  PlaceMap map = map_of(drive, config);
  Detector detector(config, map);
  take(detector, drive);
  EXPECT_TRUE(detector.evidence());
  static_cast<void>(detector.step(std::vector<float>(size, std::nanf(""))));
  EXPECT_FALSE(detector.evidence());
  static_cast<void>(detector.step(drive.back()));
  EXPECT_TRUE(detector.evidence());
  for (const std::uint64_t frames : {5U, 100U}) {
    detector.skip(frames);
    EXPECT_FALSE(detector.evidence()) << frames;
    take(detector, drive);
    EXPECT_TRUE(detector.evidence()) << frames;
  }
  static_cast<void>(detector.finish());
  EXPECT_FALSE(detector.evidence());
}

/// While all rows that are scanned show what the frame does, nothing is known of how places change.
TEST(PlaceBelief, OfPlacesThatAreTheSameIsAProbability) {
  MatcherConfig config = settings(Use::localise);
  config.keyframes = false;
  config.standardisation.on = false;
  config.relocalising.rows_scanned = 50;
  oracle::Vectors drive = way(12, 200, 0.5F, 1);
  std::fill(drive.begin(), drive.begin() + 120, drive.front());
  PlaceMap map(config, {drive.size(), size});
  for (const std::vector<float>& place : drive) ASSERT_TRUE(map.add(place));
  Detector detector(config, map);
  std::size_t believed = 0;
  for (std::size_t frame = 0; frame < 2 * drive.size(); ++frame) {
    const FrameReport report = detector.step(drive[frame % drive.size()]);
    if (!report.now) continue;
    ++believed;
    EXPECT_TRUE(report.now->probability >= 0.0F && report.now->probability <= 1.0F) << frame;
  }
  EXPECT_GT(believed, drive.size());
}

TEST(PlaceBelief, TakesAnything) {
  const std::vector<float> constant(size, 1.0F / 16.0F);
  const oracle::Vectors alike(200, constant);
  EXPECT_EQ(accepted(drive_through(alike, alike, settings(Use::localise))), 0U);
  EXPECT_EQ(accepted(drive_through({}, alike, settings(Use::close_loops))), 0U);
  const oracle::Vectors some = way(12, 200, 0.5F, 1);
  EXPECT_EQ(accepted(drive_through(alike, some, settings(Use::localise))), 0U);
  const oracle::Vectors nothing(50, std::vector<float>(size, std::nanf("")));
  const Said said = drive_through(some, nothing, settings(Use::localise));
  expect_each_frame_once(said, 50);
  EXPECT_EQ(std::ranges::count(said.answers, Gate::frame_error, &Answer::gate), 50);
  expect_each_frame_once(drive_through(some, {some[5]}, settings(Use::localise)), 1);
  expect_each_frame_once(drive_through({some[0]}, some, settings(Use::localise)), 200);
  MatcherConfig config;
  for (const float wrong : {0.0F, -1.0F, 1.5F, std::nanf("")}) {
    config.min_probability = wrong;
    EXPECT_FALSE(validate(config).empty()) << wrong;
  }
  config = {};
  config.patience = 1001;
  EXPECT_FALSE(validate(config).empty());
}

TEST(PlaceBelief, AcceptsFromNothingThatIsNoProbability) {
  const oracle::Vectors known = way(1, 200, 0.3F, 1);
  const oracle::Vectors again = way(1, 200, 0.3F, 2);
  const MatcherConfig config = settings(Use::localise);
  PlaceMap map = map_of(known, config);
  Detector plain(config, map);
  Detector told(config, map);
  std::size_t accepted = 0;
  for (const auto& seen : again) {
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), 0.0F, -1.0F, 1.01F,
                              std::numeric_limits<float>::infinity()}) {
      EXPECT_FALSE(told.accept_from(wrong)) << wrong;
    }
    const std::span<const Answer> answers = told.step(seen).answers;
    const std::span<const Answer> as_before = plain.step(seen).answers;
    ASSERT_TRUE(std::ranges::equal(answers, as_before, {}, &Answer::gate, &Answer::gate));
    accepted += static_cast<std::size_t>(std::ranges::count(answers, Gate::match, &Answer::gate));
  }
  EXPECT_GE(accepted, 100U);
}

TEST(PlaceBelief, ItsWorkIsBoundedAndInThePlan) {
  const oracle::Vectors reference = way(13, 5000, 0.5F, 1);
  const oracle::Vectors query = way(13, 300, 0.5F, 2);
  const MatcherConfig config = settings(Use::localise);
  const Work most = Detector::most_work(config, {5000, size});
  const Said said = drive_through(reference, query, config);
  EXPECT_LE(said.most.sketches, most.sketches);
  EXPECT_LE(said.most.scanned, most.scanned);
  EXPECT_GT(most.sketches, PlaceBelief::most_sketches);
}

TEST(PlaceBelief, AllMethodsDecideByIt) {
  const oracle::Vectors reference = way(14, 200, 0.5F, 1);
  const oracle::Vectors query = way(14, 200, 0.5F, 2);
  for (const Candidates candidates : {Candidates::all, Candidates::ranges, Candidates::adaptive}) {
    for (const bool relocalise : {true, false}) {
      MatcherConfig config = settings(Use::localise);
      config.candidates = candidates;
      config.relocalising.on = relocalise;
      const Said said = drive_through(reference, query, config);
      expect_each_frame_once(said, 200);
      EXPECT_GT(accepted(said), 160U);
    }
  }
}

TEST(PlaceBelief, TwoRunsSayTheSame) {
  const oracle::Vectors drive = way(15, 400, 0.5F, 1);
  const Said a = drive_through({}, drive, settings(Use::close_loops));
  const Said b = drive_through({}, drive, settings(Use::close_loops));
  for (std::size_t i = 0; i < a.answers.size(); ++i) {
    EXPECT_EQ(a.answers[i].probability, b.answers[i].probability);
    EXPECT_EQ(a.answers[i].gate, b.answers[i].gate);
  }
}

}  // namespace
}  // namespace seqloop
