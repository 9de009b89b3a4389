// SPDX-License-Identifier: MIT
// Sessions that grow side by side, as those of several robots do: each is in one piece, and answers
// do not depend on which of them stands before which.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "core/matcher.hpp"
#include "core/ways.hpp"

namespace seqloop {
namespace {

using oracle::Vectors;

/// Numbers of a session's places.
constexpr std::uint64_t apart = 1'000'000;

TEST(PlaceOrder, SessionsThatGrowSideBySideEqualLists) {
  for (const std::size_t capacity : {1U, 7U, 64U, 301U}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE("capacity " + std::to_string(capacity) + ", seed " + std::to_string(seed));
      TestArena memory;
      PlaceOrder order(memory.arena, capacity, 4);
      std::mt19937 random(seed);
      struct Place {
        std::size_t slot;
        std::uint64_t number;
      };
      std::vector<std::vector<Place>> lists;
      for (std::size_t count = 0; count < capacity; ++count) {
        const std::size_t session = random() % std::min<std::size_t>(lists.size() + 1, 4);
        if (session == lists.size()) {
          order.count_from(session * apart);
          ASSERT_TRUE(order.begin_session());
          lists.emplace_back();
        }
        const std::uint64_t number = session * apart + lists[session].size();
        ASSERT_TRUE(order.may_give(session, number));
        if (number > 0) {
          ASSERT_FALSE(order.may_give(session, number - 1));
        }
        if (session + 1 < lists.size()) {
          ASSERT_FALSE(order.may_give(session, (session + 1) * apart));
        }
        lists[session].push_back({order.insert(session, lists[session].size(), number), number});
        ASSERT_EQ(lists[session].back().slot, count) << "slots are given out in turn";
        std::size_t row = 0;
        for (std::size_t s = 0; s < lists.size(); ++s) {
          ASSERT_EQ(order.session(s).first, row);
          for (std::size_t i = 0; i < lists[s].size(); ++i, ++row) {
            ASSERT_EQ(order.slot(row), lists[s][i].slot);
            ASSERT_EQ(order.number(row), lists[s][i].number);
            ASSERT_EQ(order.frame(row), i);
            ASSERT_EQ(order.session_of(row), s);
            ASSERT_EQ(order.session_of_number(lists[s][i].number), s);
            ASSERT_EQ(order.row_of_number(lists[s][i].number), row);
          }
          ASSERT_EQ(order.session(s).last, row);
        }
        ASSERT_EQ(order.size(), row);
      }
    }
  }
}

/// Drives through a map that two robots fill meanwhile, a place each a frame.
struct Fleet {
  const MatcherConfig& config;
  const Vectors& first;   // the robot whose session stands before the other's
  const Vectors& second;  // the other's

  /// What stands for a place, whichever session is first.
  static std::string name(const Vectors& robot, std::uint64_t frame) {
    return std::to_string(robot.front().front()) + "/" + std::to_string(frame);
  }

  struct Said {
    std::string where;
    double score;
    double probability;
    bool accepted;
  };

  [[nodiscard]] std::vector<Said> drive(const Vectors& query) const {
    const Capacity room{first.size() + second.size(), query.front().size(), 2};
    PlaceMap map(config, room);
    // In the form in which they would come: as another map has saved them.
    const PlaceMap firsts = map_of(first, config);
    const PlaceMap seconds = map_of(second, config);
    std::vector<std::byte> bytes(map.rows().saved_size());
    Detector detector(config, map);
    const auto take_in = [&](const PlaceMap& from, std::size_t session, std::size_t frame) {
      if (frame >= from.size()) return;
      from.rows().save(frame, bytes);
      ASSERT_TRUE(detector.take_in(session, {session * apart + frame, frame, bytes}));
    };
    constexpr std::size_t ahead = 60;  // what both have seen before
    for (std::size_t frame = 0; frame < ahead; ++frame) take_in(firsts, 0, frame);
    map.count_from(apart);
    EXPECT_TRUE(map.begin_session());
    for (std::size_t frame = 0; frame < ahead; ++frame) take_in(seconds, 1, frame);
    std::vector<Said> all;
    const auto hear = [&](std::span<const Answer> answers) {
      for (const Answer& answer : answers) {
        Said said{"", 0.0, static_cast<double>(answer.probability), answer.gate == Gate::match};
        if (answer.match) {
          const bool of_second = answer.match->place >= apart;
          said.where = name(of_second ? second : first, answer.match->place % apart);
          said.score = static_cast<double>(answer.match->score);
        }
        all.push_back(said);
      }
    };
    for (std::size_t frame = 0; frame < query.size(); ++frame) {
      take_in(firsts, 0, ahead + frame);
      take_in(seconds, 1, ahead + frame);
      hear(detector.step(query[frame]).answers);
    }
    hear(detector.finish());
    EXPECT_EQ(map.size(), room.places);
    return all;
  }
};

TEST(TakeIn, WhoStandsFirstDoesNotMatter) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    MatcherConfig config = paper(Candidates::all, 10);
    config.full_map = FullMap::forget_oldest;
    if (seed % 2 == 0) config.arithmetic = Arithmetic::int8;
    const Vectors one = oracle::drive(seed, 200, 32, 0.2F);
    const Vectors other = oracle::drive(seed + 50, 200, 32, 0.2F);
    Vectors query = oracle::drive(seed, 70, 32, 0.4F);
    const Vectors more = oracle::drive(seed + 50, 70, 32, 0.4F);
    query.insert(query.end(), more.begin(), more.end());
    const auto there = Fleet{config, one, other}.drive(query);
    const auto back = Fleet{config, other, one}.drive(query);
    ASSERT_EQ(there.size(), back.size());
    std::size_t found = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
      ASSERT_EQ(there[i].where, back[i].where) << i;
      ASSERT_EQ(there[i].score, back[i].score) << i;
      found += !there[i].where.empty();
    }
    EXPECT_GT(found, 100U);
  }
}

TEST(TakeIn, LoopsAreFoundWhileRowsMove) {
  for (const Arithmetic arithmetic : {Arithmetic::int8, Arithmetic::float32, Arithmetic::sketch}) {
    for (const Candidates candidates : {Candidates::ranges, Candidates::adaptive}) {
      MatcherConfig config;
      config.arithmetic = arithmetic;
      config.candidates = candidates;
      config.full_map = FullMap::forget_oldest;
      const Vectors one = oracle::drive(3, 400, 64, 0.2F);
      const Vectors other = oracle::drive(4, 400, 64, 0.2F);
      const Vectors query = oracle::drive(3, 340, 64, 0.4F);
      // The session that is followed stands behind one that grows, so that its rows move with every
      // frame; and before it, where they stay.
      const auto moving = Fleet{config, other, one}.drive(query);
      const auto still = Fleet{config, one, other}.drive(query);
      ASSERT_EQ(moving.size(), query.size());
      std::size_t accepted = 0;
      std::size_t accepted_still = 0;
      for (std::size_t frame = 0; frame < query.size(); ++frame) {
        accepted_still += still[frame].accepted;
        if (!moving[frame].accepted) continue;
        ++accepted;
        bool near = false;
        for (std::size_t by = 0; by <= 4 && !near; ++by) {
          near = frame + by >= 2 && moving[frame].where == Fleet::name(one, frame + by - 2);
        }
        EXPECT_TRUE(near) << frame << ": " << moving[frame].where;
      }
      EXPECT_GT(accepted_still, 250U);
      EXPECT_GE(accepted, accepted_still - accepted_still / 20);
    }
  }
}

/// Views along a road, of what lies ahead: less and less of it with the distance.
Vectors views_ahead(std::uint32_t seed, std::uint32_t visit) {
  Vectors road = test::way(seed, 400, 3.0F, visit, 256, 0.96F);
  std::ranges::reverse(road);
  return road;
}

/// Two robots on one road, one behind the other.
TEST(TakeIn, WhoNearsWhereAnotherHasBegunIsNotThereYet) {
  constexpr std::size_t ahead = 60;
  constexpr std::size_t later = 15;  // frames until the other knows of a place
  std::size_t found = 0;
  std::size_t possible = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    MatcherConfig config;
    config.standardisation.on = false;
    config.full_map = FullMap::forget_oldest;
    const Vectors behind = views_ahead(seed, 1);
    Vectors before = views_ahead(seed, 2);
    before.erase(before.begin(), before.begin() + ahead);
    const PlaceMap its = map_of(before, config);
    std::vector<std::byte> bytes(its.rows().saved_size());
    PlaceMap map(config, {before.size(), 256, 2});
    Detector detector(config, map);
    const auto hear = [&](std::span<const Answer> answers) {
      for (const Answer& answer : answers) {
        if (answer.gate != Gate::match) continue;
        const double off =
            static_cast<double>(answer.match->place + ahead) - static_cast<double>(answer.frame);
        EXPECT_LE(std::abs(off), 10.0) << answer.frame;
        ++found;
      }
    };
    for (std::size_t frame = 0; frame < before.size(); ++frame) {
      if (frame >= later) {
        its.rows().save(frame - later, bytes);
        ASSERT_TRUE(detector.take_in(0, {frame - later, frame - later, bytes}));
      }
      hear(detector.step(behind[frame]).answers);
      possible += frame >= ahead;
    }
    hear(detector.finish());
  }
  EXPECT_GT(found, possible * 3 / 4);
}

TEST(TakeIn, OnlyWhatFollows) {
  MatcherConfig config;
  config.full_map = FullMap::forget_oldest;
  PlaceMap map(config, {4, 4, 2});
  Detector detector(config, map);
  const std::vector<std::byte> place(4, std::byte{5});
  EXPECT_TRUE(detector.take_in(0, {0, 0, place}));
  map.count_from(10);
  ASSERT_TRUE(map.begin_session());
  EXPECT_TRUE(detector.take_in(1, {10, 0, place}));
  EXPECT_FALSE(detector.take_in(0, {0, 1, place})) << "numbers ascend";
  EXPECT_FALSE(detector.take_in(0, {10, 1, place})) << "that one is the next session's";
  EXPECT_FALSE(detector.take_in(0, {1, 0, place})) << "frames ascend";
  EXPECT_FALSE(detector.take_in(0, {1, 1, std::span(place).first(3)}));
  EXPECT_TRUE(detector.take_in(0, {1, 1, place}));
  EXPECT_TRUE(detector.take_in(0, {9, 7, place}));
  EXPECT_FALSE(detector.take_in(1, {11, 1, place})) << "full";
  EXPECT_EQ(map.order().session(0).last, 3U);
  EXPECT_EQ(map.order().number(3), 10U);
}

TEST(TakeIn, NothingForASessionThatIsNotThere) {
  MatcherConfig config;
  config.use = Use::close_loops;
  config.full_map = FullMap::thin;
  PlaceMap map(config, {100, 16, 3});
  const Vectors drive = oracle::drive(1, 3, 16);
  ASSERT_TRUE(map.add(drive[0]));
  std::vector<std::byte> saved(map.rows().saved_size());
  map.rows().save(0, saved);
  ASSERT_TRUE(map.begin_session());
  Detector detector(config, map);
  for (const std::size_t session : {std::size_t{2}, std::size_t{3}, PlaceOrder::far}) {
    EXPECT_FALSE(detector.take_in(session, {7, 7, saved})) << session;
    EXPECT_FALSE(map.add_saved_to(session, {7, 7, saved})) << session;
  }
  EXPECT_EQ(map.size(), 1U);
}

/// Another robot's place comes before the first step of the drive that is added.
TEST(TakeIn, IsOfItsSessionWhereTheNextHasNoPlaceYet) {
  MatcherConfig config{.use = Use::close_loops, .full_map = FullMap::thin};
  PlaceMap map(config, {100, 16, 2});
  const Vectors drive = oracle::drive(1, 60, 16);
  for (std::size_t i = 0; i < 30; ++i) ASSERT_TRUE(map.add(drive[i]));
  std::vector<std::byte> saved(map.rows().saved_size());
  map.rows().save(3, saved);
  map.count_from(apart);
  Detector detector(config, map);
  const std::size_t places = map.size();
  const std::uint64_t next = map.order().number(places - 1) + 1;
  ASSERT_TRUE(detector.take_in(0, {next, 100, saved}));
  EXPECT_EQ(map.order().session(0).last, places + 1);
  for (const auto& descriptor : drive) static_cast<void>(detector.step(descriptor));
  const CandidateRun own = map.order().session(1);
  ASSERT_EQ(own.first, places + 1);
  ASSERT_GT(own.last, own.first);
  EXPECT_EQ(map.order().number(own.first), apart);
  EXPECT_EQ(map.order().frame(own.first), 0U);
}

TEST(TakeIn, AMapThatKeepsOrderTakesInNothingBetween) {
  const MatcherConfig config;
  PlaceMap map(config, {4, 4, 2});
  const std::vector<std::byte> place(4, std::byte{5});
  EXPECT_EQ(map.add_saved_to(0, {0, 0, place}), 0U);
  map.count_from(10);
  ASSERT_TRUE(map.begin_session());
  EXPECT_EQ(map.add_saved_to(0, {1, 1, place}), std::nullopt) << "another has been begun";
  EXPECT_EQ(map.add_saved_to(1, {10, 0, place}), 1U);
  EXPECT_EQ(map.add_saved_to(0, {1, 1, place}), std::nullopt);
}

}  // namespace
}  // namespace seqloop
