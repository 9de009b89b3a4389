// SPDX-License-Identifier: MIT
// Maps of several sessions: answered as the best of their maps, one by one; nothing crosses a
// border; what is saved and put back answers alike.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>

#include "core/matcher.hpp"
#include "core/shown_drive.hpp"
#include "core/ways.hpp"

namespace seqloop {
namespace {

using oracle::Vectors;

/// A map of these sessions, with room for a drive that is added.
PlaceMap map_of_sessions(const std::vector<Vectors>& sessions, const MatcherConfig& config,
                         std::size_t more) {
  std::size_t places = more;
  for (const Vectors& session : sessions) places += session.size();
  PlaceMap map(config, {places, sessions.front().front().size(), sessions.size() + 1});
  for (const Vectors& session : sessions) {
    EXPECT_TRUE(map.begin_session());
    for (const auto& place : session) static_cast<void>(map.learn(place));
    for (const auto& place : session) EXPECT_TRUE(map.add(place));
  }
  return map;
}

std::vector<FrameReport> run_through(PlaceMap& map, const Vectors& query,
                                     const MatcherConfig& config) {
  Detector detector(config, map);
  std::vector<FrameReport> all;
  for (const auto& descriptor : query) all.push_back(detector.step(descriptor));
  return all;
}

/// Puts places of a session into another map, in batches of 1, 2, 3 and so on.
void put_back(const PlaceMap& map, PlaceMap& into) {
  const std::size_t size = map.rows().saved_size();
  std::vector<std::byte> bytes(map.size() * size);
  std::vector<PlaceMap::Saved> places;
  for (std::size_t row = 0; row < map.size(); ++row) {
    const std::span<std::byte> place = std::span(bytes).subspan(row * size, size);
    map.rows().save(map.order().slot(row), place);
    places.push_back({map.order().number(row), map.order().frame(row), place});
  }
  std::size_t batch = 1;
  for (std::size_t first = 0; first < places.size(); first += batch++) {
    const auto some = std::span(places).subspan(first, std::min(batch, places.size() - first));
    ASSERT_EQ(into.add_saved(some), some.size());
  }
  for (std::size_t row = 0; row < map.size(); ++row) {
    into.set_first_visit(row, map.first_visit(row));
  }
}

/// A report of one of the maps that the sessions are, one by one.
struct OfOne {
  const Match* match;
  std::size_t first;  // its first place's number in the map of all
  bool has_runner_up;
};

class Sessions : public testing::TestWithParam<Arithmetic> {};

TEST_P(Sessions, AreSearchedAsTheBestOfTheirMaps) {
  std::size_t answered = 0;
  std::size_t in_running = 0;
  std::size_t in_earlier = 0;
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    MatcherConfig config = paper(Candidates::all, std::vector<std::size_t>{0, 1, 5, 20}[seed % 4],
                                 seed % 3 == 0 ? Use::localise : Use::close_loops);
    config.arithmetic = GetParam();
    config.enhance = seed % 5 == 0;
    config.exclude = 6 + seed % 40;
    config.rwindow = 2 + seed % 9;
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<Vectors> sessions{oracle::drive(seed, 30 + 17 * (seed % 9), 24, 0.3F),
                                        oracle::drive(seed + 100, 150, 24, 0.3F)};
    // First through the one, then through the other, then through the first part again.
    Vectors query = oracle::drive(seed, 60, 24, 0.5F);
    const Vectors other = oracle::drive(seed + 100, 60, 24, 0.5F);
    const Vectors again = oracle::drive(seed + 300, 60, 24, 0.2F);
    for (const Vectors& part : {other, again, again}) {
      query.insert(query.end(), part.begin(), part.end());
    }
    std::vector<std::vector<FrameReport>> apart;
    for (const Vectors& session : sessions) {
      MatcherConfig one = config;
      one.use = Use::localise;
      apart.push_back(reports(session, query, one));
    }
    if (config.use == Use::close_loops) apart.push_back(reports({}, query, config));

    PlaceMap map = map_of_sessions(sessions, config, query.size());
    const std::vector<FrameReport> together = run_through(map, query, config);
    for (std::size_t frame = 0; frame < query.size(); ++frame) {
      std::optional<OfOne> best;
      std::uint64_t candidates = 0;
      std::size_t first = 0;
      for (std::size_t session = 0; session < apart.size(); ++session) {
        const FrameReport& report = apart[session][frame];
        candidates += report.work.candidates;
        if (report.match && (!best || report.match->score < best->match->score)) {
          best = {&*report.match, first, report.work.candidates > config.rwindow + 1};
        }
        if (session < sessions.size()) first += sessions[session].size();
      }
      const FrameReport& report = together[frame];
      ASSERT_EQ(report.match.has_value(), best.has_value()) << frame;
      ASSERT_EQ(report.work.candidates, candidates) << frame;
      if (!best) continue;
      ++answered;
      ++(best->first == sessions[0].size() + sessions[1].size() ? in_running : in_earlier);
      ASSERT_EQ(report.match->place, best->match->place + best->first) << frame;
      ASSERT_EQ(report.match->head, best->match->head + best->first) << frame;
      ASSERT_EQ(report.match->score, best->match->score) << frame;
      if (best->has_runner_up) {
        ASSERT_EQ(report.match->uniqueness, best->match->uniqueness) << frame;
      }
    }
  }
  EXPECT_GT(answered, 3'000U);
  EXPECT_GT(in_running, 300U);
  EXPECT_GT(in_earlier, 1'000U);
}

/// All that a detector can be, in a map that grows.
std::vector<MatcherConfig> kinds(Arithmetic arithmetic) {
  std::vector<MatcherConfig> kinds;
  for (const Candidates candidates : {Candidates::all, Candidates::ranges, Candidates::adaptive}) {
    for (const bool relocalise : {false, true}) {
      for (const Decision decision : {Decision::uniqueness, Decision::probability}) {
        MatcherConfig config;
        config.arithmetic = arithmetic;
        config.candidates = candidates;
        config.relocalising.on = relocalise;
        config.relocalising.rows_scanned = 64;
        config.decision = decision;
        config.use = Use::close_loops;
        config.exclude = 40;
        kinds.push_back(config);
      }
    }
  }
  return kinds;
}

TEST_P(Sessions, NoLineRunsAcrossABorder) {
  // One way, cut in three: a line across would fit best.
  const Vectors way = oracle::drive(7, 240, 64, 0.2F);
  const std::vector<Vectors> sessions{{way.begin(), way.begin() + 80},
                                      {way.begin() + 80, way.begin() + 160},
                                      {way.begin() + 160, way.end()}};
  const Vectors again = oracle::drive(7, 240, 64, 0.4F);
  for (MatcherConfig config : kinds(GetParam())) {
    for (const Use use : {Use::localise, Use::close_loops}) {
      config.use = use;
      PlaceMap map = map_of_sessions(sessions, config, 240);
      Detector detector(config, map);
      std::size_t matches = 0;
      for (std::size_t frame = 0; frame < 240; ++frame) {
        if (frame % 50 == 49) detector.skip(1 + frame % 7);
        const FrameReport report = detector.step(again[frame]);
        if (!report.match) continue;
        ++matches;
        EXPECT_EQ(map.order().session_of_number(report.match->place),
                  map.order().session_of_number(report.match->head))
            << "frame " << frame;
      }
      EXPECT_GT(matches, 100U);
    }
  }
}

TEST_P(Sessions, EarlierPlacesAreCandidatesFromTheFirstFrameOn) {
  const Vectors earlier = oracle::drive(8, 200, 64, 0.2F);
  const Vectors query = oracle::drive(8, 120, 64, 0.4F);
  for (const MatcherConfig& config : kinds(GetParam())) {
    PlaceMap map = map_of_sessions({earlier}, config, query.size());
    std::size_t right = 0;
    for (const FrameReport& report : run_through(map, query, config)) {
      if (!report.match) continue;
      if (report.match->place >= earlier.size()) {
        EXPECT_LT(report.match->place - earlier.size() + config.exclude, *report.frame);
      }
      right += report.match->place <= *report.frame + 2 && *report.frame <= report.match->place + 2;
    }
    EXPECT_EQ(map.size(), 320U);
    EXPECT_EQ(map.order().frame(200), 0U);
    EXPECT_GT(right, 60U) << static_cast<int>(config.candidates) << config.relocalising.on
                          << static_cast<int>(config.decision);
  }
}

TEST_P(Sessions, ThatShowTheSamePlacesDoNotContestThem) {
  // One road, as five drives saw it; nobody knows yet that they are one.
  std::vector<Vectors> five;
  for (const float noise : {0.5F, 0.51F, 0.52F, 0.53F, 0.54F}) {
    five.push_back(oracle::drive(9, 300, 64, noise));
  }
  const Vectors query = oracle::drive(9, 300, 64, 0.6F);
  MatcherConfig config;
  config.arithmetic = GetParam();
  std::array<std::size_t, 2> accepted{};
  for (const std::size_t several : {0U, 1U}) {
    PlaceMap map =
        map_of_sessions({five.begin(), several == 1 ? five.end() : five.begin() + 1}, config, 0);
    Detector detector(config, map);
    const auto count = [&](std::span<const Answer> answers) {
      for (const Answer& answer : answers) accepted[several] += answer.gate == Gate::match;
    };
    for (const auto& seen : query) count(detector.step(seen).answers);
    count(detector.finish());
  }
  std::printf("accepted in one session %zu, in five %zu\n", accepted[0], accepted[1]);
  EXPECT_GT(accepted[0], 150U);
  EXPECT_GE(accepted[1], accepted[0] - accepted[0] / 20);
}

TEST_P(Sessions, ThatWasSeenBetterDoesNotContestTheOneThatIsFollowed) {
  // The robot comes along a road as one drive saw it, badly. From `known` on another drive saw it
  // well, so that its lines are much the better; nobody knows yet that the two are one road.
  MatcherConfig config;
  config.arithmetic = GetParam();
  constexpr std::size_t known = 60;
  std::size_t accepted = 0;
  std::size_t right = 0;
  constexpr std::size_t roads = 8;
  constexpr std::size_t size = 240;
  for (std::uint32_t road = 1; road <= roads; ++road) {
    const Vectors badly = test::way(road, size, 2.0F, 1);
    const Vectors whole = test::way(road, size, 0.1F, 2);
    const Vectors well(whole.begin() + known, whole.end());
    PlaceMap map = map_of_sessions({badly, well}, config, 0);
    Detector detector(config, map);
    const auto count = [&](std::span<const Answer> answers) {
      for (const Answer& answer : answers) {
        if (answer.gate != Gate::match) continue;
        ++accepted;
        const std::uint64_t place = answer.match->place;
        const std::uint64_t frame = place < size ? place : place - size + known;
        right += static_cast<std::size_t>(frame <= answer.frame + 5 && answer.frame <= frame + 5);
      }
    };
    for (const auto& seen : test::way(road, size, 0.5F, 3)) count(detector.step(seen).answers);
    count(detector.finish());
  }
  std::printf("accepted %zu of %zu, right %zu\n", accepted, roads * size, right);
  EXPECT_GT(accepted, roads * size * 9 / 10);
  EXPECT_EQ(right, accepted);
}

/// A road that one session saw up to a border, and another from a little before it on; what both
/// saw is linked. Either session may be the older one.
struct RoadOfTwo {
  static constexpr std::size_t border = 100;
  static constexpr std::size_t both = 14;
  static constexpr std::size_t past = 60;

  static constexpr std::size_t end = border + past;

  PlaceMap map;
  std::size_t second;  // its first row

  /// @param noise of the second session
  RoadOfTwo(std::uint32_t road, float noise, bool ends_first, const MatcherConfig& config)
      : map(of_sessions(road, noise, ends_first, config)), second(ends_first ? border : 0) {
    const std::size_t first = ends_first ? 0 : both + past;
    for (std::size_t row = 0; row < both; ++row) {
      const std::size_t a = first + border - both + row;
      const std::size_t b = second + row;
      map.set_first_visit(std::max(a, b), map.order().number(std::min(a, b)));
    }
  }

  static PlaceMap of_sessions(std::uint32_t road, float noise, bool ends_first,
                              const MatcherConfig& config) {
    const Vectors ends = test::way(road, border, 0.5F, 1);
    const Vectors whole = test::way(road, end, noise, 2);
    const Vectors goes_on(whole.begin() + (border - both), whole.end());
    return ends_first ? map_of_sessions({ends, goes_on}, config, 0)
                      : map_of_sessions({goes_on, ends}, config, 0);
  }

  /// The frame of the road that a place of the second session is; none for one of the first.
  [[nodiscard]] std::optional<std::size_t> frame(std::uint64_t place) const {
    if (place < second || place >= second + both + past) return std::nullopt;
    return static_cast<std::size_t>(place) - second + border - both;
  }
};

TEST_P(Sessions, OneThatEndsHandsOverHowTheRobotCame) {
  // Past the border the robot sees so badly that it hardly finds out anew where it is, but it has
  // come there along a road that it knows well.
  MatcherConfig config;
  config.arithmetic = GetParam();
  constexpr std::size_t border = RoadOfTwo::border;
  for (const bool ends_first : {true, false}) {
    std::size_t right = 0;
    std::size_t wrong = 0;
    for (std::uint32_t road = 1; road <= 24; ++road) {
      Vectors query = test::way(road, border, 0.5F, 3);
      const Vectors badly = test::way(road, RoadOfTwo::end, 24.0F, 3);
      query.insert(query.end(), badly.begin() + border, badly.end());
      RoadOfTwo both(road, 0.5F, ends_first, config);
      Detector detector(config, both.map);
      const auto count = [&](std::span<const Answer> answers) {
        for (const Answer& answer : answers) {
          if (answer.frame < border || answer.gate != Gate::match) continue;
          const auto frame = both.frame(answer.match->place);
          const bool is = frame && *frame <= answer.frame + 5 && answer.frame <= *frame + 5;
          (is ? right : wrong) += 1;
        }
      };
      for (const auto& seen : query) count(detector.step(seen).answers);
      count(detector.finish());
    }
    std::printf("accepted past the border: %zu right, %zu wrong of %zu\n", right, wrong,
                24 * RoadOfTwo::past);
    EXPECT_GT(right, 870U) << ends_first;
    // It sees next to nothing: a few are further off.
    EXPECT_LE(wrong, ends_first ? 8U : 12U);
  }
}

TEST_P(Sessions, OneThatEndsHandsOverWhatIsBelievedOfIt) {
  // The second session saw the road so badly that its rows are hardly believed while the first
  // one's are there.
  MatcherConfig config;
  config.arithmetic = GetParam();
  constexpr std::size_t border = RoadOfTwo::border;
  for (const bool ends_first : {true, false}) {
    std::size_t goes_on = 0;
    for (std::uint32_t road = 1; road <= 24; ++road) {
      RoadOfTwo both(road, 8.0F, ends_first, config);
      Detector detector(config, both.map);
      const Vectors query = test::way(road, RoadOfTwo::end, 0.5F, 3);
      for (std::size_t seen = 0; seen < border + 6; ++seen) {
        const FrameReport report = detector.step(query[seen]);
        if (seen < border + 3 || !report.now) continue;
        const auto frame = both.frame(report.now->place);
        const bool there = frame && *frame <= seen + 3 && seen <= *frame + 3;
        goes_on += static_cast<std::size_t>(there && report.now->new_place < 0.1F);
      }
    }
    std::printf("believed past the border: %zu of %d\n", goes_on, 24 * 3);
    EXPECT_GT(goes_on, 50U) << ends_first;
  }
}

/// Of the members: what lies between them is nobody's.
bool same_bits(const Match& a, const Match& b) {
  const auto bits = [](const Match& match) {
    return std::tuple(match.place, match.head, std::bit_cast<std::uint32_t>(match.score),
                      std::bit_cast<std::uint32_t>(match.uniqueness),
                      std::bit_cast<std::uint64_t>(match.velocity));
  };
  return bits(a) == bits(b);
}

TEST_P(Sessions, WhatIsSavedAndPutBackAnswersAlike) {
  const Vectors first = oracle::drive(9, 150, 40, 0.2F);
  Vectors second = oracle::drive(9, 100, 40, 0.4F);
  const Vectors anew = oracle::drive(10, 80, 40, 0.2F);
  for (const Vectors& part : {anew, anew}) second.insert(second.end(), part.begin(), part.end());
  for (const MatcherConfig& config : kinds(GetParam())) {
    const Capacity room{first.size() + second.size(), 40, 2};
    PlaceMap map(config, room);
    PlaceMap loaded(config, room);
    {
      Detector detector(config, map);
      Vectors laps = first;
      for (const auto& descriptor : laps) static_cast<void>(detector.step(descriptor));
      static_cast<void>(detector.finish());
      const RunningStatistics& learnt = detector.statistics();
      const std::vector<double> mean(learnt.mean().begin(), learnt.mean().end());
      const std::vector<double> variance(learnt.variance().begin(), learnt.variance().end());
      ASSERT_TRUE(map.set_statistics(mean, variance, learnt.frames()));
      ASSERT_TRUE(loaded.set_statistics(mean, variance, learnt.frames()));
    }
    put_back(map, loaded);
    const std::vector<FrameReport> wanted = run_through(map, second, config);
    const std::vector<FrameReport> got = run_through(loaded, second, config);
    std::size_t matches = 0;
    for (std::size_t frame = 0; frame < second.size(); ++frame) {
      ASSERT_EQ(got[frame].match.has_value(), wanted[frame].match.has_value());
      ASSERT_EQ(got[frame].gate, wanted[frame].gate);
      ASSERT_EQ(got[frame].work, wanted[frame].work);
      if (!got[frame].match) continue;
      ++matches;
      ASSERT_TRUE(same_bits(*got[frame].match, *wanted[frame].match)) << frame;
    }
    EXPECT_GT(matches, 100U);
  }
}

TEST_P(Sessions, PlacesGoFromTheOldestOrWhereTheyAreDensest) {
  const Vectors earlier = oracle::drive(11, 150, 40, 0.2F);
  const Vectors query = oracle::drive(12, 200, 40, 0.2F);
  for (MatcherConfig config : kinds(GetParam())) {
    for (const FullMap full_map : {FullMap::forget_oldest, FullMap::thin}) {
      config.full_map = full_map;
      const std::vector<Vectors> halves{{earlier.begin(), earlier.begin() + 75},
                                        {earlier.begin() + 75, earlier.end()}};
      PlaceMap map = map_of_sessions(halves, config, 100);
      for (const FrameReport& report : run_through(map, query, config)) {
        ASSERT_FALSE(report.map_full);
        if (!report.match) continue;
        ASSERT_EQ(map.order().session_of_number(report.match->place),
                  map.order().session_of_number(report.match->head));
      }
      // Two hundred came, there was room for a hundred.
      const PlaceOrder& order = map.order();
      EXPECT_EQ(map.size(), 250U);
      EXPECT_EQ(order.sessions(), 3U);
      std::size_t sum = 0;
      for (std::size_t session = 0; session < 3; ++session) {
        const CandidateRun rows = order.session(session);
        ASSERT_EQ(rows.first, sum);
        sum = rows.last;
        for (std::size_t row = rows.first; row < rows.last; ++row) {
          EXPECT_EQ(order.session_of(row), session);
          EXPECT_EQ(order.session_of_number(order.number(row)), session);
          EXPECT_EQ(order.frame(row), order.number(row) - (session < 2 ? 75 * session : 150));
        }
      }
      EXPECT_EQ(sum, 250U);
      if (full_map == FullMap::forget_oldest) {
        EXPECT_EQ(order.session(0).last, 0U);
        EXPECT_EQ(order.session(1).last, 50U);
        EXPECT_EQ(order.number(0), 100U);
      } else {
        // The ends of a session have no two neighbours, and stay.
        for (const std::uint64_t end : {0U, 74U, 75U, 149U, 150U}) {
          bool stays = false;
          for (std::size_t row = 0; row < map.size(); ++row) {
            stays = stays || order.number(row) == end;
          }
          EXPECT_TRUE(stays) << end;
        }
      }
    }
  }
}

TEST(MapOfSessions, ADriveNeedsRoomForItsOwn) {
  MatcherConfig config = paper(Candidates::all, 5, Use::close_loops);
  PlaceMap map(config, {40, 9, 1});
  for (const auto& place : oracle::drive(1, 20, 9)) EXPECT_TRUE(map.add(place));
  EXPECT_THROW(Detector(config, map), SetupError);
  config.use = Use::localise;
  const Detector reads_only(config, map);
  EXPECT_EQ(map.order().sessions(), 1U);
}

TEST(MapOfSessions, PutBackTogetherTheyHaveTheSketchesOfEach) {
  for (const Arithmetic arithmetic : {Arithmetic::float32, Arithmetic::int8, Arithmetic::sketch}) {
    MatcherConfig config;
    config.arithmetic = arithmetic;
    PlaceMap map(config, {40, 50, 1});
    for (const auto& place : oracle::drive(3, 40, 50)) ASSERT_TRUE(map.add(place));
    PlaceMap loaded(config, {40, 50, 1});
    put_back(map, loaded);
    ASSERT_EQ(loaded.size(), 40U);
    std::vector<std::uint32_t> bits(map.size());
    std::vector<std::uint32_t> loaded_bits(map.size());
    for (std::size_t row = 0; row < map.size(); ++row) {
      EXPECT_EQ(map.rows().look_closely(loaded.rows(), row, row), 0U) << row;
      map.rows().scan(map.rows(), row, 0, bits);
      loaded.rows().scan(map.rows(), row, 0, loaded_bits);
      EXPECT_EQ(loaded_bits, bits) << row;
    }
  }
}

TEST(MapOfSessions, PutBackTogetherUpToWhatDoesNotFit) {
  const MatcherConfig config;
  PlaceMap map(config, {40, 4, 1});
  std::vector<std::vector<std::byte>> bytes(30, std::vector<std::byte>(4, std::byte{5}));
  bytes[20][3] = std::byte{0x80};
  std::vector<PlaceMap::Saved> places;
  for (std::size_t i = 0; i < bytes.size(); ++i) places.push_back({i, i, bytes[i]});
  EXPECT_EQ(map.add_saved(places), 20U);
  EXPECT_EQ(map.size(), 20U);
  EXPECT_EQ(map.rows().look_closely(map.rows(), 0, 19), 0U) << "sketched before that";
  EXPECT_EQ(map.add_saved(std::span(places).subspan(21)), 9U);
  EXPECT_EQ(map.add_saved(std::span<const PlaceMap::Saved>()), 0U);
}

TEST(MapOfSessions, PutBackOnlyWhatFits) {
  MatcherConfig config;
  PlaceMap map(config, {3, 4, 1});
  const std::vector<std::byte> place(4, std::byte{5});
  std::vector<std::byte> beyond = place;
  beyond[2] = std::byte{0x80};
  EXPECT_FALSE(map.add_saved({0, 0, std::span(place).first(3)}));
  EXPECT_FALSE(map.add_saved({0, 0, beyond})) << "-128 is no value of a place";
  EXPECT_FALSE(map.add_saved({PlaceMap::number_end, 0, place})) << "the next would have none";
  EXPECT_FALSE(map.add_saved({0, PlaceMap::number_end, place}));
  EXPECT_TRUE(map.add_saved({7, 3, place}));
  EXPECT_FALSE(map.add_saved({7, 4, place})) << "numbers ascend";
  EXPECT_FALSE(map.add_saved({8, 3, place})) << "frames ascend";
  EXPECT_TRUE(map.add_saved({9, 5, place}));
  EXPECT_TRUE(map.add_saved({10, 6, place}));
  EXPECT_FALSE(map.add_saved({11, 7, place})) << "full";
  EXPECT_EQ(map.order().number(0), 7U);
  EXPECT_FALSE(map.set_statistics(std::vector<double>(4), std::vector<double>(4, -1.0), 5));
  EXPECT_FALSE(map.set_statistics(std::vector<double>(3), std::vector<double>(3), 5));
  EXPECT_TRUE(map.set_statistics(std::vector<double>(4), std::vector<double>(4, 1.0), 5));
}

INSTANTIATE_TEST_SUITE_P(Arithmetics, Sessions,
                         testing::Values(Arithmetic::int8, Arithmetic::float32,
                                         Arithmetic::sketch));

}  // namespace
}  // namespace seqloop
