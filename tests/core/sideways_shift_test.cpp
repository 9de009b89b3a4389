// SPDX-License-Identifier: MIT
// How far to the side frames are moved: beside its definition, learnt from what places show, and
// what it is good for.
#include "seqloop/detail/sideways_shift.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/matcher.hpp"
#include "core/panorama.hpp"

namespace seqloop {
namespace {

using test::Panorama;

constexpr std::size_t columns = Panorama::columns;
constexpr std::size_t size = Panorama::size;
constexpr int most = 6;  // halves
constexpr std::size_t rows_between = SidewaysShift::rows_unmoved - 1;

/// A descriptor moved as the header says, in double.
std::vector<float> moved(const std::vector<float>& descriptor, int halves) {
  std::vector<double> out(descriptor.size());
  double squares = 0.0;
  for (std::size_t d = 0; d < out.size(); ++d) {
    const auto column = static_cast<double>(d % columns) + halves / 2.0;
    const auto at = [&](double c) {
      const auto inside = static_cast<std::size_t>(std::clamp(c, 0.0, double{columns - 1}));
      return static_cast<double>(descriptor[d - d % columns + inside]);
    };
    out[d] = (at(std::floor(column)) + at(std::ceil(column))) / 2.0;
    squares += out[d] * out[d];
  }
  std::vector<float> unit;
  for (const double value : out) {
    unit.push_back(static_cast<float>(squares > 0.0 ? value / std::sqrt(squares) : 0.0));
  }
  return unit;
}

MatcherConfig in(Arithmetic arithmetic) {
  MatcherConfig config;
  config.arithmetic = arithmetic;
  return config;
}

/// Places of a map, one for each frame, and what learns from them.
class Learner {
 public:
  explicit Learner(Arithmetic arithmetic, std::size_t known = columns, bool on = true)
      : config_(as_they_come(arithmetic)),
        map_(config_, {3'000, size}),
        queries_(memory_.arena, DescriptorForm(config_, size), 2, true),
        shift(memory_.arena, DescriptorForm(config_, size), on) {
    shift.stand_in(known);
  }

  std::size_t learn(const std::vector<float>& frame, const std::vector<float>& place,
                    double novelty = 0.5) {
    EXPECT_TRUE(map_.add(place));
    queries_.push(frame, shift.moved(frame));
    return shift.learn(queries_, frame, map_, map_.size() - 1, novelty);
  }

 private:
  static MatcherConfig as_they_come(Arithmetic arithmetic) {
    MatcherConfig config = in(arithmetic);
    config.standardisation.on = false;
    return config;
  }

  TestArena memory_;
  MatcherConfig config_;
  PlaceMap map_;
  QueryHistory queries_;

 public:
  SidewaysShift shift;
};

class Shifts : public testing::TestWithParam<Arithmetic> {};

TEST_P(Shifts, AreFoundAndUndoneByTheirDefinition) {
  const oracle::Vectors frames = Panorama(1, 200).seen(columns, 0.0F, 1);
  for (int halves = -most; halves <= most; ++halves) {
    Learner learner(GetParam());
    for (const auto& frame : frames) {
      const std::size_t computed = learner.learn(frame, moved(frame, halves));
      EXPECT_GE(computed, 1U);
      EXPECT_LE(computed, SidewaysShift::distances);
    }
    EXPECT_EQ(learner.shift.halves(), halves);
    const std::span<const float> undone = learner.shift.moved(frames[5]);
    const std::vector<float> wanted = moved(frames[5], halves);
    for (std::size_t d = 0; d < size; ++d) ASSERT_NEAR(undone[d], wanted[d], 1e-6F) << d;
  }
}

TEST_P(Shifts, StayAtNoneWhereNothingIsMoved) {
  const Panorama panorama(2, 400);
  const oracle::Vectors frames = panorama.seen(columns, 1.0F, 1);
  const oracle::Vectors places = panorama.seen(columns, 1.0F, 2);
  Learner learner(GetParam());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    static_cast<void>(learner.learn(frames[i], places[i]));
    ASSERT_EQ(learner.shift.halves(), 0) << i;
  }
  EXPECT_EQ(learner.shift.moved(frames[0]).data(), frames[0].data()) << "nothing is copied";
}

TEST_P(Shifts, FollowARobotBackToItsOldTrack) {
  const oracle::Vectors frames = Panorama(3, 300).seen(columns, 0.0F, 1);
  Learner learner(GetParam());
  for (const auto& frame : frames) static_cast<void>(learner.learn(frame, moved(frame, 4)));
  ASSERT_EQ(learner.shift.halves(), 4);
  for (const auto& frame : frames) static_cast<void>(learner.learn(frame, frame));
  EXPECT_EQ(learner.shift.halves(), 0);
  for (const auto& frame : frames) static_cast<void>(learner.learn(frame, moved(frame, -4)));
  EXPECT_EQ(learner.shift.halves(), -4);
  for (int lost = 0; lost < 200; ++lost) learner.shift.learn_nothing();
  EXPECT_EQ(learner.shift.halves(), -4);
  static_cast<void>(learner.learn(frames[0], moved(frames[0], -4)));
  for (int lost = 0; lost < 200; ++lost) learner.shift.learn_nothing();
  EXPECT_EQ(learner.shift.halves(), -4) << "it was seen in between";
  learner.shift.learn_nothing();
  EXPECT_EQ(learner.shift.halves(), 0);
}

TEST_P(Shifts, LearnNothingFromFramesThatShowNothingNewOrNothing) {
  const oracle::Vectors frames = Panorama(4, 100).seen(columns, 0.0F, 1);
  const std::vector<float> nothing(size, 0.0F);
  Learner learner(GetParam());
  for (const auto& frame : frames) {
    static_cast<void>(learner.learn(frame, moved(frame, 3), 0.0));
    static_cast<void>(learner.learn(nothing, frame));
    static_cast<void>(learner.learn(nothing, nothing));
    ASSERT_EQ(learner.shift.halves(), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Arithmetic, Shifts,
                         testing::Values(Arithmetic::float32, Arithmetic::int8,
                                         Arithmetic::sketch));

// A robot that turns sees with a row too far back what it would see beside it.
TEST_P(Shifts, LearnNothingWhereARowBesideIsMoreAlike) {
  const oracle::Vectors frames = Panorama(5, 200).seen(columns, 0.0F, 1);
  for (const bool has_better : {false, true}) {
    Learner learner(GetParam());
    for (const auto& frame : frames) {
      std::vector<float> other = frame;
      if (!has_better) std::ranges::transform(other, other.begin(), std::negate<>());
      static_cast<void>(learner.learn(frame, other, 0.0));
      const std::size_t computed = learner.learn(frame, moved(frame, 4));
      EXPECT_EQ(computed < 4, has_better) << computed;
    }
    EXPECT_EQ(learner.shift.halves(), has_better ? 0 : 4);
  }
}

// Whatever it takes it for, it has no reason to move what some row shows as it is.
TEST_P(Shifts, AreGivenUpWhereARowNearByShowsTheFrameAsItCame) {
  const oracle::Vectors frames = Panorama(7, 200).seen(columns, 0.0F, 1);
  const oracle::Vectors noise = Panorama(8, 200).seen(columns, 0.0F, 1);
  const std::vector<float> none(size, 0.0F);
  const std::vector<std::pair<std::size_t, bool>> cases{
      {0, true}, {rows_between, true}, {rows_between, false}, {rows_between + 1, true}};
  for (const auto& [between, much] : cases) {
    Learner learner(GetParam());
    for (const auto& frame : frames) static_cast<void>(learner.learn(frame, moved(frame, 4)));
    ASSERT_EQ(learner.shift.halves(), 4);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      std::vector<float> place = moved(frames[i], 4);
      std::ranges::transform(place, noise[i], place.begin(), std::plus<>());
      ASSERT_TRUE(normalise(place));
      // As it came, or hardly more like it than the place is.
      std::vector<float> other = frames[i];
      if (!much) {
        std::ranges::transform(other, noise[(i + 7) % frames.size()], other.begin(), std::plus<>());
        ASSERT_TRUE(normalise(other));
      }
      if (between > 0) static_cast<void>(learner.learn(none, other, 0.0));
      for (std::size_t row = 0; row < between; ++row) {
        static_cast<void>(learner.learn(none, none, 0.0));
      }
      static_cast<void>(learner.learn(frames[i], place));
    }
    EXPECT_EQ(learner.shift.halves(), between == rows_between && much ? 0 : 4) << between;
  }
}

TEST(SidewaysShift, IsNoneWhereColumnsAreNotKnown) {
  const oracle::Vectors frames = Panorama(6, 50).seen(columns, 0.0F, 1);
  for (const bool on : {false, true}) {
    for (const std::size_t known : {std::size_t{0}, std::size_t{1}, columns}) {
      if (on && known == columns) continue;
      Learner learner(Arithmetic::int8, known, on);
      for (const auto& frame : frames) {
        EXPECT_EQ(learner.learn(frame, moved(frame, 2)), 0U);
        EXPECT_EQ(learner.shift.moved(frame).data(), frame.data());
      }
    }
  }
}

/// What is accepted of a drive that sees what the map's saw, moved to the side from some frame on.
struct Found {
  std::size_t right = 0;
  std::size_t wrong = 0;
};

Found found(Arithmetic arithmetic, std::size_t known_columns, std::size_t aside, Use use,
            std::size_t from = 0) {
  constexpr std::size_t places = 300;
  const Panorama panorama(6, places);
  MatcherConfig config = in(arithmetic);
  config.use = use;
  const bool loops = use == Use::close_loops;
  oracle::Vectors drive = panorama.seen(columns, 1.2F, 1);
  PlaceMap map(config, {loops ? 2 * places : places, size});
  EXPECT_TRUE(map.set_columns(known_columns));
  if (!loops) fill(map, drive);
  oracle::Vectors back = panorama.seen(columns + aside, 1.2F, 2);
  const oracle::Vectors on_track = panorama.seen(columns, 1.2F, 3);
  std::ranges::copy(std::span(on_track).first(from), back.begin());
  if (!loops) drive.clear();
  const std::size_t first = drive.size();
  drive.insert(drive.end(), back.begin(), back.end());

  Detector detector(config, map);
  const Work most_work = Detector::most_work(config, {map.capacity(), size});
  Found found;
  const auto take = [&](std::span<const Answer> answers) {
    for (const Answer& answer : answers) {
      if (answer.gate != Gate::match) continue;
      const bool right = answer.frame >= first && answer.match->place + 2 + first >= answer.frame &&
                         answer.match->place + first <= answer.frame + 2;
      ++(right ? found.right : found.wrong);
    }
  };
  for (const auto& frame : drive) {
    const FrameReport report = detector.step(frame);
    EXPECT_LE(report.work.distances, most_work.distances);
    take(report.answers);
  }
  take(detector.finish());
  return found;
}

TEST_P(Shifts, LetARobotBesideItsOldTrackBeFound) {
  for (const Use use : {Use::localise, Use::close_loops}) {
    const Found without = found(GetParam(), 0, 2, use);
    const Found with = found(GetParam(), columns, 2, use);
    EXPECT_LT(without.right, 50U) << "or this shows nothing";
    EXPECT_GE(with.right, 270U);
    EXPECT_EQ(with.wrong, 0U);
  }
}

// Another lane looks less like the map at first: that is not where the robot is any less.
TEST_P(Shifts, LetARobotBeFoundThatChangesLanes) {
  const Found with = found(GetParam(), columns, 2, Use::localise, 120);
  EXPECT_GE(with.right, 240U) << "179 where it is not learnt";
  EXPECT_LE(with.wrong, 1U);
}

TEST_P(Shifts, ChangeNothingWhereNothingIsMoved) {
  for (const Use use : {Use::localise, Use::close_loops}) {
    const Found with = found(GetParam(), columns, 0, use);
    EXPECT_GE(with.right, 280U);
    EXPECT_EQ(with.wrong, 0U);
  }
}

TEST(PlaceMap, TakesColumnsThatItsDescriptorsCanStandIn) {
  PlaceMap map({}, {10, 12});
  EXPECT_EQ(map.columns(), 0U);
  EXPECT_TRUE(map.set_columns(4));
  EXPECT_FALSE(map.set_columns(5));
  EXPECT_FALSE(map.set_columns(24));
  EXPECT_EQ(map.columns(), 4U) << "as it was";
  EXPECT_TRUE(map.set_columns(0));
  EXPECT_EQ(map.columns(), 0U);
}

}  // namespace
}  // namespace seqloop
