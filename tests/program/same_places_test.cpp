// SPDX-License-Identifier: MIT
// Which places of several sessions are one, against plain lists.
#include "program/fleet/same_places.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace seqloop::program {
namespace {

constexpr std::uint64_t apart = 1'000'000;
constexpr std::uint64_t away = 20;

class Rows {
 public:
  Rows(std::size_t sessions, std::size_t frames)
      : frames_(frames), map_(config(), {sessions * frames, 4, sessions}), same_(map_, away) {
    const std::vector<std::byte> bytes(map_.rows().saved_size(), std::byte{1});
    for (std::size_t session = 0; session < sessions; ++session) {
      map_.count_from(session * apart);
      EXPECT_TRUE(map_.begin_session());
      for (std::size_t frame = 0; frame < frames; ++frame) {
        EXPECT_TRUE(map_.add_saved({session * apart + frame, frame, bytes}));
        same_.added(map_.size() - 1);
      }
    }
  }

  [[nodiscard]] std::size_t row(std::uint64_t number) const {
    return static_cast<std::size_t>(number / apart) * frames_ +
           static_cast<std::size_t>(number % apart);
  }
  [[nodiscard]] bool one(std::uint64_t a, std::uint64_t b) const {
    return map_.same_place(row(a), row(b));
  }
  [[nodiscard]] std::uint64_t name(std::size_t row) const { return map_.first_visit(row); }
  [[nodiscard]] std::size_t size() const { return map_.size(); }
  SamePlaces& same() { return same_; }

 private:
  static MatcherConfig config() {
    MatcherConfig config;
    config.full_map = FullMap::forget_oldest;
    return config;
  }
  std::size_t frames_;
  PlaceMap map_;
  SamePlaces same_;
};

TEST(SamePlaces, HangTogetherInWhateverOrderTheyAreTold) {
  // Anna's is Bert's, Carl's is Dora's, and then Bert's is Dora's.
  Rows rows(4, 100);
  rows.same().join(50, apart + 70);
  rows.same().join(2 * apart + 20, 3 * apart + 90);
  EXPECT_FALSE(rows.one(50, 2 * apart + 20));
  rows.same().join(apart + 70, 3 * apart + 90);
  for (const std::uint64_t a : {std::uint64_t{50}, apart + 70, 2 * apart + 20, 3 * apart + 90}) {
    for (const std::uint64_t b : {std::uint64_t{50}, apart + 70, 2 * apart + 20, 3 * apart + 90}) {
      EXPECT_TRUE(rows.one(a, b)) << a << ' ' << b;
    }
  }
  EXPECT_FALSE(rows.one(20, apart + 70));
}

TEST(SamePlaces, EqualsListsThatAreWalkedThrough) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rows rows(5, 40);
    std::vector<std::uint64_t> names;
    for (std::size_t row = 0; row < rows.size(); ++row) names.push_back(rows.name(row));
    std::mt19937 random(seed);
    for (int link = 0; link < 300; ++link) {
      const std::uint64_t a = random() % 5 * apart + random() % 40;
      const std::uint64_t b = random() % 5 * apart + random() % 40;
      const auto first = std::min(names[rows.row(a)], names[rows.row(b)]);
      const auto last = std::max(names[rows.row(a)], names[rows.row(b)]);
      if (last - first >= away) std::ranges::replace(names, last, first);
      rows.same().join(a, b);
      for (std::size_t row = 0; row < rows.size(); ++row) ASSERT_EQ(rows.name(row), names[row]);
    }
  }
}

TEST(SamePlaces, ARoadDoesNotBecomeOnePlaceByLinksThatAreOff) {
  // Three sessions of one road; whoever tells is off by up to three frames.
  Rows rows(3, 400);
  std::mt19937 random(3);
  for (int link = 0; link < 20'000; ++link) {
    const std::uint64_t from = random() % 3;
    const std::uint64_t to = random() % 3;
    const std::uint64_t frame = 3 + random() % 394;
    if (from != to) rows.same().join(from * apart + frame, to * apart + frame + random() % 7 - 3);
  }
  std::size_t one = 0;
  for (std::uint64_t frame = 3; frame < 397; ++frame) {
    one += rows.one(frame, 2 * apart + frame);
    if (frame + 60 < 397) {
      EXPECT_FALSE(rows.one(frame, apart + frame + 60)) << frame;
    }
  }
  EXPECT_GE(one, 380U) << "of 394";
}

TEST(SamePlaces, WhatLiesBetweenTwoThatAreToldIsOneToo) {
  Rows rows(2, 100);
  SamePlaces::Told told;
  rows.same().join(apart + 10, 30, told);
  rows.same().join(apart + 40, 60, told);
  EXPECT_EQ(rows.name(rows.row(apart + 25)), 45U);
  // Too far apart, and backwards: nothing is known of what lies between.
  rows.same().join(apart + 90, 5, told);
  EXPECT_EQ(rows.name(rows.row(apart + 70)), apart + 70);
}

TEST(SamePlaces, OfWhatIsNotThereNothingIs) {
  Rows rows(2, 10);
  rows.same().join(3, apart + 10);
  rows.same().join(10, apart);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    EXPECT_EQ(rows.row(rows.name(row)), row);
  }
}

}  // namespace
}  // namespace seqloop::program
