// SPDX-License-Identifier: MIT
// Robots that set off at once on one road find what one that had all their maps would find.
#include "program/fleet/others_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "core/oracle.hpp"
#include "core/panorama.hpp"
#include "program/fleet/through_own.hpp"

namespace seqloop::program {
namespace {

using oracle::Vectors;

constexpr std::size_t size = 64;
constexpr std::size_t lap = 300;
constexpr std::uint64_t on_the_way = 15;      // frames until others know what is told
constexpr std::uint64_t settled_after = 180;  // frames after which the map's file has a link

/// A robot that drives round, and what it tells.
class Robot {
 public:
  Robot(std::uint32_t index, std::size_t robots, const Vectors& drive)
      : index_(index),
        drive_(&drive),
        own_(config(), {drive.size(), size, 2}),
        detector_(config(), own_),
        others_(config(), robots * drive.size(), robots, own_),
        through_own_(config(), own_),
        heard_(robots),
        heard_links_(robots) {}

  void step(const std::vector<std::unique_ptr<Robot>>& all) {
    const std::uint64_t now = places_.size();
    const std::span<const Answer> mine = detector_.step((*drive_)[now]).answers;
    places_.emplace_back(own_.rows().saved_size());
    own_.rows().save(own_.order().slot(now), places_.back());
    if (now >= settled_after) {
      const std::uint64_t frame = now - settled_after;
      const std::uint64_t first = own_.first_visit(static_cast<std::size_t>(frame));
      if (first != frame) links_.push_back({now, frame, {index_, first}});
    }
    for (const auto& other : all) {
      if (other->index_ != index_) hear(*other, now);
    }
    const std::span<const Answer> theirs = others_.step((*drive_)[now], 0).answers;
    link(theirs, now);
    note(through_own_.take(mine, theirs));
  }

  void finish() { note(through_own_.finish(detector_.finish(), others_.finish())); }

  [[nodiscard]] const std::set<std::uint64_t>& found() const { return found_; }
  [[nodiscard]] std::size_t wrong() const { return wrong_; }

  /// Frames for which one process that had all others' places from the start finds a loop with what
  /// another had seen two windows before.
  [[nodiscard]] std::set<std::uint64_t> one_process(
      const std::vector<std::unique_ptr<Robot>>& all) const {
    PlaceMap map(config(), {all.size() * drive_->size(), size, all.size()});
    std::uint64_t number = 0;
    for (const auto& other : all) {
      if (other->index_ == index_) continue;
      EXPECT_TRUE(map.begin_session());
      const std::size_t first = map.size();
      for (const auto& place : other->places_) {
        EXPECT_TRUE(map.add_saved({number + map.size() - first, map.size() - first, place}));
      }
      for (std::size_t row = first; row < map.size(); ++row) {
        map.set_first_visit(row, number + other->own_.first_visit(row - first));
      }
      number = map.order().next_number();
      const RunningStatistics& its = other->detector_.statistics();
      EXPECT_TRUE(map.set_statistics({its.mean().begin(), its.mean().end()},
                                     {its.variance().begin(), its.variance().end()}, its.frames()));
    }
    Detector detector(config(), map);
    std::set<std::uint64_t> found;
    const auto hear = [&](std::span<const Answer> answers) {
      for (const Answer& answer : answers) {
        if (answer.gate != Gate::match || answer.match->place >= number) continue;
        if (answer.match->place % drive_->size() + 40 <= answer.frame) found.insert(answer.frame);
      }
    };
    for (const auto& seen : *drive_) hear(detector.step(seen).answers);
    hear(detector.finish());
    return found;
  }

 private:
  struct Link {
    std::uint64_t when;
    std::uint64_t frame;
    OthersMap::Place other;
  };

  static MatcherConfig config() {
    MatcherConfig config;
    config.use = Use::close_loops;
    return config;
  }

  void hear(const Robot& other, std::uint64_t now) {
    for (std::uint64_t& frame = heard_[other.index_];
         frame < other.places_.size() && frame + on_the_way <= now; ++frame) {
      ASSERT_TRUE(others_.take_in({other.index_, frame}, other.places_[frame]));
    }
    for (std::size_t& link = heard_links_[other.index_];
         link < other.links_.size() && other.links_[link].when + on_the_way <= now; ++link) {
      others_.same_place({other.index_, other.links_[link].frame}, other.links_[link].other);
    }
  }

  void link(std::span<const Answer> answers, std::uint64_t now) {
    for (const Answer& answer : answers) {
      if (!answer.match || !(answer.probability >= 0.9F)) continue;
      links_.push_back({now, answer.frame, others_.where(answer.match->place)});
    }
  }

  void note(std::span<const Answer> answers) {
    for (const Answer& answer : answers) {
      if (answer.gate != Gate::match || !answer.match) continue;
      const OthersMap::Place place = others_.where(answer.match->place);
      found_.insert(answer.frame);
      // All have set off at other places of the road, a seventh of it apart.
      const std::size_t here = answer.frame + index_ * (lap / 7);
      const std::size_t there = place.frame + place.session * (lap / 7);
      const std::size_t off = (here + lap - there % lap) % lap;
      wrong_ += std::min(off, lap - off) > 10;
    }
  }

  std::uint32_t index_;
  const Vectors* drive_;
  PlaceMap own_;
  Detector detector_;
  OthersMap others_;
  ThroughOwn through_own_;
  std::vector<std::uint64_t> heard_;
  std::vector<std::size_t> heard_links_;
  std::vector<std::vector<std::byte>> places_;
  std::vector<Link> links_;
  std::set<std::uint64_t> found_;
  std::size_t wrong_ = 0;
};

TEST(OthersMap, SixRobotsThatSetOffAtOnceFindWhatOneProcessFinds) {
  constexpr std::uint32_t robots = 6;
  constexpr std::size_t frames = 2 * lap + 50;
#if defined(__SANITIZE_ADDRESS__)
  constexpr std::uint32_t seeds = 1;  // Another adds no code, and takes 20 seconds.
#else
  constexpr std::uint32_t seeds = 2;
#endif
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    std::vector<Vectors> drives(robots);
    for (std::uint32_t robot = 0; robot < robots; ++robot) {
      for (std::size_t round = 0; round < 4; ++round) {
        // The road is the same each time; what blurs it is not.
        const float noise = 0.5F + 0.01F * static_cast<float>(robot * 4 + round);
        const Vectors seen = oracle::drive(seed, lap, size, noise);
        drives[robot].insert(drives[robot].end(), seen.begin(), seen.end());
      }
      const auto first = drives[robot].begin() + robot * (lap / 7);
      drives[robot] = Vectors(first, first + frames);
    }
    std::vector<std::unique_ptr<Robot>> all;
    for (std::uint32_t robot = 0; robot < robots; ++robot) {
      all.push_back(std::make_unique<Robot>(robot, robots, drives[robot]));
    }
    for (std::size_t frame = 0; frame < frames; ++frame) {
      for (const auto& robot : all) robot->step(all);
    }
    std::size_t possible = 0;
    std::size_t found = 0;
    std::size_t accepted = 0;
    std::size_t wrong = 0;
    for (const auto& robot : all) {
      robot->finish();
      const auto of_one = robot->one_process(all);
      possible += of_one.size();
      for (const std::uint64_t frame : of_one) found += robot->found().count(frame);
      accepted += robot->found().size();
      wrong += robot->wrong();
    }
    std::printf("seed %u: of %zu found %zu; accepted %zu, wrong %zu\n", seed, possible, found,
                accepted, wrong);
    EXPECT_GT(possible, 500U);
    EXPECT_GE(found, possible - possible / 100);
    EXPECT_LE(wrong, accepted / 100);
  }
}

// What the run's own map knows of columns goes for others' places, too.
TEST(OthersMap, FindsARobotThatDrivesBesideAnothersTrack) {
  using test::Panorama;
  constexpr std::size_t frames = 300;
  const Panorama panorama(6, frames);
  MatcherConfig config;
  const auto found = [&](std::size_t columns) {
    PlaceMap places(config, {frames, Panorama::size});
    for (const auto& seen : panorama.seen(7, 1.2F, 1)) EXPECT_TRUE(places.add(seen));
    PlaceMap own(config, {frames, Panorama::size});
    EXPECT_TRUE(own.set_columns(columns));
    OthersMap others(config, frames, 2, own);
    std::vector<std::byte> bytes(places.rows().saved_size());
    for (std::size_t row = 0; row < frames; ++row) {
      places.rows().save(places.order().slot(row), bytes);
      EXPECT_TRUE(others.take_in({1, row}, bytes));
    }
    std::size_t matches = 0;
    const auto count = [&](std::span<const Answer> answers) {
      matches += static_cast<std::size_t>(std::ranges::count(answers, Gate::match, &Answer::gate));
    };
    for (const auto& seen : panorama.seen(9, 1.2F, 2)) count(others.step(seen, 0).answers);
    count(others.finish());
    return matches;
  };
  EXPECT_LT(found(0), 50U);
  EXPECT_GT(found(Panorama::columns), 250U);
}

}  // namespace
}  // namespace seqloop::program
