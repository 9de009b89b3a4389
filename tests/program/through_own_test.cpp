// SPDX-License-Identifier: MIT
// Loops with other robots that follow from the robot's own.
#include "program/fleet/through_own.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace seqloop::program {
namespace {

constexpr std::size_t places = 200;

class ThroughOwnTest : public ::testing::Test {
 protected:
  ThroughOwnTest() : own_(config(), {2 * places, 8}), through_(config(), own_) {
    const std::vector<std::byte> place(own_.rows().saved_size());
    for (std::size_t n = 0; n < places; ++n) EXPECT_TRUE(own_.add_saved({n, n, place}));
  }

  static MatcherConfig config() {
    MatcherConfig config;
    config.use = Use::close_loops;
    config.standardisation.on = false;
    return config;
  }

  static Answer answer(std::uint64_t frame, Gate gate, std::size_t place, float probability) {
    Answer answer;
    answer.frame = frame;
    answer.gate = gate;
    answer.probability = probability;
    answer.match = Match{place, 0.5F, 0.7F, 1.0, place};
    return answer;
  }
  static Answer nothing(std::uint64_t frame) {
    Answer answer;
    answer.frame = frame;
    answer.gate = Gate::new_place;
    answer.probability = 0.1F;
    return answer;
  }

  void take(const std::vector<Answer>& own, const std::vector<Answer>& others) {
    keep(through_.take(own, others));
  }
  void keep(std::span<const Answer> answers) {
    for (const Answer& given : answers) {
      EXPECT_TRUE(told_.emplace(given.frame, given).second) << "twice: " << given.frame;
    }
  }

  PlaceMap own_;
  ThroughOwn through_;
  std::map<std::uint64_t, Answer> told_;
};

TEST_F(ThroughOwnTest, BackWhereAnotherWasFoundItIsFoundAgain) {
  take({}, {answer(20, Gate::match, 1020, 0.995F)});
  EXPECT_EQ(told_.at(20).match->place, 1020U) << "what is accepted waits for nothing";
  take({nothing(20)}, {});
  // Frame 150 is at its own place 22, two behind 20; others' answer comes first.
  take({}, {nothing(150)});
  EXPECT_EQ(told_.count(150), 0U);
  take({answer(150, Gate::match, 22, 0.999F)}, {});
  EXPECT_EQ(told_.at(150).gate, Gate::match);
  EXPECT_EQ(told_.at(150).match->place, 1022U);
  EXPECT_FLOAT_EQ(told_.at(150).probability, 0.995F) << "the less sure of the two";
  // The other way round.
  take({answer(151, Gate::match, 21, 0.992F)}, {});
  take({}, {answer(151, Gate::unsure, 1500, 0.4F)});
  EXPECT_EQ(told_.at(151).match->place, 1021U);
  EXPECT_FLOAT_EQ(told_.at(151).probability, 0.992F);
  take({answer(152, Gate::match, 17, 0.992F)}, {nothing(152)});
  EXPECT_EQ(told_.at(152).match->place, 1017U);
}

TEST_F(ThroughOwnTest, WhatFollowsFromNothingStaysAsItIs) {
  take({nothing(20)}, {answer(20, Gate::match, 1020, 0.995F)});
  take({answer(150, Gate::match, 40, 0.999F)}, {nothing(150)});
  EXPECT_EQ(told_.at(150).gate, Gate::new_place) << "own place 40 is not 20";
  take({answer(151, Gate::unsure, 20, 0.8F)}, {nothing(151)});
  EXPECT_EQ(told_.at(151).gate, Gate::new_place) << "the own loop is not accepted";
  take({answer(152, Gate::match, 20, 0.999F)}, {answer(152, Gate::match, 1300, 0.995F)});
  EXPECT_EQ(told_.at(152).match->place, 1300U) << "what others' map says itself";
}

TEST_F(ThroughOwnTest, VisitsOfOnePlaceAreOne) {
  own_.set_first_visit(100, 30);
  // Others' place is found at frame 100, a visit of 30; the robot comes back, and 30 is named.
  take({}, {answer(100, Gate::match, 1100, 0.995F)});
  take({answer(100, Gate::match, 30, 0.999F)}, {});
  take({answer(180, Gate::match, 31, 0.999F)}, {nothing(180)});
  ASSERT_EQ(told_.at(180).gate, Gate::match);
  EXPECT_EQ(told_.at(180).match->place, 1101U);
}

TEST_F(ThroughOwnTest, EachFrameHasOneAnswerInTheEnd) {
  for (std::uint64_t frame = 0; frame < 500; ++frame) {
    take({}, {nothing(frame)});  // the own ones never come
  }
  keep(through_.finish({}, {}));
  EXPECT_EQ(told_.size(), 500U);
}

TEST_F(ThroughOwnTest, ByUniquenessNothingFollows) {
  MatcherConfig by_uniqueness = config();
  by_uniqueness.decision = Decision::uniqueness;
  ThroughOwn through(by_uniqueness, own_);
  const std::vector<Answer> others{nothing(3)};
  EXPECT_EQ(through.take({}, others).size(), 1U);
  EXPECT_TRUE(through.finish({}, {}).empty());
}

}  // namespace
}  // namespace seqloop::program
