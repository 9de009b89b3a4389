// SPDX-License-Identifier: MIT
// A slow robot, a fast camera and a robot that stands show the same sequence as any.
#include "seqloop/detail/keyframes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/matcher.hpp"
#include "core/ways.hpp"
#include "seqloop/detail/frame_steps.hpp"
#include "seqloop/detail/stop_frames.hpp"
#include "seqloop/detail/usual.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

using oracle::Vectors;
using enum FrameSteps::Shows;

/// A drive with a stop.
Vectors with_stop(const Vectors& drive, std::size_t at, std::size_t frames) {
  Vectors stops(drive.begin(), drive.begin() + static_cast<std::ptrdiff_t>(at));
  for (std::size_t i = 0; i < frames; ++i) stops.push_back(drive[at]);
  stops.insert(stops.end(), drive.begin() + static_cast<std::ptrdiff_t>(at), drive.end());
  return stops;
}

/// Whether each frame of a drive is a keyframe. @param variance of its features
std::vector<bool> keyframes_of(const Vectors& drive, double variance, double spacing = 0.0) {
  ArenaMemory memory(1 << 16, {});
  Arena arena(memory.span());
  Keyframes keyframes(arena, drive.front().size());
  if (spacing > 0.0) keyframes.go_by(spacing);
  std::vector<bool> are;
  for (const auto& descriptor : drive) are.push_back(keyframes.take(descriptor, variance));
  return are;
}

/// The same with a copy of each of the two frames that the next are compared with.
class NaiveKeyframes {
 public:
  bool take(const std::vector<float>& descriptor, double variance) {
    const double unrelated = 2.0 * variance;
    const bool was_dense = dense_;
    if (was_dense) in_a_row_ = 0;
    ++since_change_;
    const bool changed =
        squared_distance(last_change_, descriptor) > (was_dense ? 0.125 : 0.1) * unrelated;
    const double differs = squared_distance(last_, descriptor);
    if (changed) {
      apart_.take(static_cast<double>(std::min<std::uint64_t>(since_change_, 4)));
      since_change_ = 0;
      dense_ = ++changes_ <= 40 ? apart_.mean() > 1.8 : dense_ || apart_.mean() > 2.2;
      last_change_ = descriptor;
    }
    if (was_dense ? !changed : differs <= 0.15 * new_.mean() * unrelated) return false;
    if (!was_dense && is_noise(descriptor, differs, unrelated)) return false;
    last_ = descriptor;
    ++keyframes_;
    if (earlier_.empty() || ++since_earlier_ == 17) {
      since_earlier_ = 0;
      earlier_ = descriptor;
    }
    new_.take(std::min(differs, unrelated) / unrelated);
    return true;
  }

 private:
  bool is_noise(const std::vector<float>& descriptor, double differs, double unrelated) {
    const bool still =
        keyframes_ >= 40 && since_earlier_ >= 8 && differs < 0.6 * unrelated &&
        unrelated - squared_distance(earlier_, descriptor) >= 0.95 * (unrelated - differs) &&
        (in_a_row_ == 0 || unrelated - differs >= 0.85 * alike_ / static_cast<double>(in_a_row_));
    if (in_a_row_ == 0 || !still) alike_ = 0.0;
    alike_ += unrelated - differs;
    in_a_row_ = still ? in_a_row_ + 1 : 0;
    return in_a_row_ >= 6;
  }

  Usual apart_{1.0, 5.0};
  Usual new_{0.1};
  bool dense_ = false;
  std::uint64_t changes_ = 0;
  std::uint64_t since_change_ = 0;
  std::uint64_t keyframes_ = 0;
  std::uint64_t since_earlier_ = 0;
  std::uint64_t in_a_row_ = 0;
  double alike_ = 0.0;  // sum in that row
  std::vector<float> earlier_;
  std::vector<float> last_ = std::vector<float>(2, 0.0F);
  std::vector<float> last_change_ = last_;
};

double variance_of(const Vectors& drive) {
  double sum = 0.0;
  for (std::size_t d = 0; d < drive.front().size(); ++d) {
    double mean = 0.0;
    double squares = 0.0;
    for (const auto& descriptor : drive) {
      mean += static_cast<double>(descriptor[d]);
      squares += static_cast<double>(descriptor[d]) * static_cast<double>(descriptor[d]);
    }
    const auto n = static_cast<double>(drive.size());
    sum += squares / n - mean / n * (mean / n);
  }
  return sum;
}

/// What steps are remembered in.
struct Memory {
  ArenaMemory memory{1 << 12, {}};

  /// @param steps, frames that are remembered
  [[nodiscard]] FrameSteps steps(std::size_t steps, std::size_t frames) const {
    Arena arena(memory.span());
    return {arena, steps, frames};
  }
};

TEST(Keyframes, AreAllFramesWhereEachShowsSomethingNew) {
  const Vectors drive = test::way(1, 300, 0.3F, 1);
  EXPECT_EQ(std::ranges::count(keyframes_of(drive, variance_of(drive)), true), 300);
}

TEST(Keyframes, OfASlowRobotAreThoseThatShowSomethingNew) {
  const Vectors slow = test::slowly(test::way(1, 200, 0.0F, 1), 8, 1);
  const std::vector<bool> are = keyframes_of(slow, variance_of(slow));
  const auto half = static_cast<std::ptrdiff_t>(slow.size() / 2);
  const auto later = std::count(are.begin() + half, are.end(), true);
  EXPECT_GT(later, half / 10);
  EXPECT_LT(later, half / 2) << "of as many frames";
}

TEST(Keyframes, LeaveOutAStop) {
  const Vectors drive = test::way(1, 200, 0.3F, 1);
  const std::vector<bool> are = keyframes_of(with_stop(drive, 100, 300), variance_of(drive));
  EXPECT_EQ(std::ranges::count(are, true), 200);
  EXPECT_TRUE(std::all_of(are.begin(), are.begin() + 101, [](bool is) { return is; }));
  EXPECT_TRUE(std::all_of(are.begin() + 401, are.end(), [](bool is) { return is; }));
}

// Frames that are one of the two, both or none, in all orders.
TEST(Keyframes, AreThoseOfTheNaiveRule) {
  std::mt19937 dice(20261126);  // NOLINT(*-msc51-cpp): the same each time
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::size_t keyframes = 0;
  constexpr std::size_t frames = 20000;
  // The last two of a drive whose second half is slower or faster.
  for (const auto& [first, then] :
       {std::pair{0.2, 0.2}, {1.0, 1.0}, {3.0, 3.0}, {0.2, 3.0}, {3.0, 0.2}}) {
    ArenaMemory memory(1 << 16, {});
    Arena arena(memory.span());
    Keyframes fast(arena, 2);
    NaiveKeyframes naive;
    double angle = 0.0;
    for (std::size_t i = 0; i < frames; ++i) {
      // Mostly small steps either way, now and then none, and seldom another scene.
      const double kind = any(dice);
      if (kind > 0.1) angle += (any(dice) - 0.3) / (i < frames / 2 ? first : then);
      if (kind > 0.98) angle += 2.0;
      const std::vector<float> descriptor{static_cast<float>(std::cos(angle)),
                                          static_cast<float>(std::sin(angle))};
      const bool is = naive.take(descriptor, 1.0);
      ASSERT_EQ(fast.take(descriptor, 1.0), is) << first << ", " << then << ", " << i;
      keyframes += is ? 1 : 0;
    }
  }
  EXPECT_GT(keyframes, frames / 2);
  EXPECT_LT(keyframes, 5 * frames - frames / 2);
}

// A lap that is sampled in two ways is known in part only when it is driven again.
TEST(Keyframes, AreSampledAlikeFromTheFirstChangesOn) {
  const Vectors slow = test::slowly(test::way(1, 100, 0.0F, 1), 3, 1);
  const std::vector<bool> are = keyframes_of(slow, variance_of(slow));
  EXPECT_LT(std::count(are.begin() + 30, are.begin() + 90, true), 30) << "of 60";
}

// Who is carried out of a house first, say, or turns on the spot.
TEST(Keyframes, AreFoundLateWhereADriveBeginsFast) {
  Vectors drive = test::way(1, 60, 0.3F, 1);
  const Vectors slow = test::slowly(test::way(2, 200, 0.0F, 1), 4, 1);
  drive.insert(drive.end(), slow.begin(), slow.end());
  const std::vector<bool> are = keyframes_of(drive, variance_of(drive));
  EXPECT_EQ(std::count(are.begin(), are.begin() + 60, true), 60);
  EXPECT_LT(std::count(are.end() - 300, are.end(), true), 150);
}

// The same frames are few beside a map whose places differ much, and all beside one like them.
TEST(Keyframes, OfADriveDoNotDependOnTheOneBefore) {
  constexpr double variance = 0.5;
  const Vectors drive = oracle::drive(3, 60, 16, 0.05F);
  ArenaMemory memory(1 << 16, {});
  Arena arena(memory.span());
  Keyframes keyframes(arena, drive.front().size());
  const auto take_all = [&] {
    std::vector<bool> are;
    for (const auto& descriptor : drive) are.push_back(keyframes.take(descriptor, variance));
    return are;
  };
  const std::vector<bool> alone = take_all();
  EXPECT_TRUE(keyframes.take(oracle::drive(4, 1, 16).front(), variance));
  EXPECT_TRUE(keyframes.take(drive.front(), variance)) << "as the next drive begins";
  keyframes.begin();
  EXPECT_EQ(take_all(), alone);
}

TEST(Keyframes, ThatNeverCameAreAsManyInOneCallAsInSeveral) {
  const Vectors slow = test::slowly(test::way(1, 200, 0.0F, 1), 8, 1);
  ArenaMemory memory(1 << 16, {});
  Arena arena(memory.span());
  Keyframes once(arena, slow.front().size());
  Keyframes often(arena, slow.front().size());
  const double variance = variance_of(slow);
  for (const auto& descriptor : slow) {
    ASSERT_EQ(once.take(descriptor, variance), often.take(descriptor, variance));
  }
  ASSERT_TRUE(once.is_dense());
  std::uint64_t sum = 0;
  for (int frame = 0; frame < 16; ++frame) sum += often.skip(1);
  EXPECT_GT(sum, 2U);
  EXPECT_LT(sum, 16U);
  EXPECT_EQ(once.skip(16), sum);
}

// As of a camera every second picture of which cannot be read: nobody knows that the scene takes
// more than a frame to change. Where it does, what is seen of it shows that.
TEST(Keyframes, AreAllThatAreSeenWhereOthersAreLost) {
  const auto seen = [](const Vectors& drive, std::size_t lost) {
    ArenaMemory memory(1 << 16, {});
    Arena arena(memory.span());
    Keyframes keyframes(arena, drive.front().size());
    const double variance = variance_of(drive);
    std::size_t count = 0;
    for (std::size_t at = 0; at < drive.size(); at += lost + 1) {
      count += keyframes.take(drive[at], variance) ? 1U : 0U;
      static_cast<void>(keyframes.skip(lost));
    }
    return std::pair(count, keyframes.is_dense());
  };
  const Vectors fast = test::way(1, 120, 0.0F, 1);
  for (const std::size_t lost : {1U, 2U, 5U, 9U}) {
    EXPECT_EQ(seen(fast, lost), std::pair(fast.size() / (lost + 1), false)) << lost;
  }
  const Vectors slow = test::slowly(test::way(1, 200, 0.0F, 1), 8, 1);
  EXPECT_TRUE(seen(slow, 1).second);
}

// Now and then one looks like the last change, and the one that is lost beside it may have, too.
TEST(Keyframes, AreAllWhereTheRobotIsSlowNowAndThenAndHalfIsLost) {
  ArenaMemory memory(1 << 16, {});
  Arena arena(memory.span());
  Keyframes keyframes(arena, 2);
  constexpr std::array steps{0.4F, 0.4F, 0.4F, 0.1F, 0.1F};
  float angle = 0.0F;
  for (std::size_t frame = 0; frame < 400; ++frame) {
    angle += steps[frame % steps.size()];
    if (frame % 2 == 1) {
      (void)keyframes.skip(1);
    } else {
      (void)keyframes.take(std::array{std::cos(angle), std::sin(angle)}, 0.5);
    }
    EXPECT_FALSE(keyframes.is_dense()) << frame;
  }
}

// What was known of it before holds where most are lost.
TEST(Keyframes, StayFewWhereADriveIsDenseAndMostIsLost) {
  const Vectors slow = test::slowly(test::way(1, 300, 0.0F, 1), 4, 1);
  const double variance = variance_of(slow);
  ArenaMemory memory(1 << 16, {});
  Arena arena(memory.span());
  Keyframes keyframes(arena, slow.front().size());
  keyframes.go_by(0.25);
  for (std::size_t at = 0; at < 400; ++at) (void)keyframes.take(slow[at], variance);
  ASSERT_TRUE(keyframes.is_dense());
  for (std::size_t at = 400; at < slow.size(); at += 4) {
    (void)keyframes.take(slow[at], variance);
    (void)keyframes.skip(3);
  }
  EXPECT_TRUE(keyframes.is_dense());
}

TEST(Keyframes, GoByTheMapThatTheyAreMatchedWith) {
  const Vectors slow = test::slowly(test::way(1, 200, 0.0F, 1), 3, 1);
  const double variance = variance_of(slow);
  const auto all = static_cast<std::ptrdiff_t>(slow.size());
  EXPECT_EQ(std::ranges::count(keyframes_of(slow, variance, 0.01), true), all);
  EXPECT_LT(std::ranges::count(keyframes_of(slow, variance, 0.5), true), 2 * all / 3);
}

TEST(Keyframes, OfADriveDoNotDependOnOneThatHasEnded) {
  const MatcherConfig config{.use = Use::close_loops};
  const Vectors dense = test::slowly(test::way(3, 150, 0.0F, 1), 5, 1);
  const Vectors fast = test::way(9, 300, 0.0F, 1, dense.front().size(), 0.92F);
  PlaceMap map(config, {dense.size() + fast.size(), dense.front().size()});
  Detector detector(config, map);
  for (const auto& seen : dense) static_cast<void>(detector.step(seen));
  static_cast<void>(detector.finish());
  const std::size_t before = map.size();
  EXPECT_LT(before, dense.size() / 2);
  for (const auto& seen : fast) static_cast<void>(detector.step(seen));
  EXPECT_EQ(map.size() - before, fast.size());
}

TEST(Keyframes, GoByWhatTellsPlacesApartAndNotByTheSnowThatFellThere) {
  // Each frame of the drive is one of the map's; half of what the map shows is snow.
  MatcherConfig config;
  config.use = Use::localise;
  const Vectors query = test::way(3, 200, 0.1F, 2, 256, 0.85F);
  PlaceMap map = map_of(test::way(3, 200, 1.9F, 1, 256, 0.85F), config);
  Detector detector(config, map);
  std::size_t right = 0;
  const auto count = [&](std::span<const Answer> answers) {
    for (const Answer& answer : answers) {
      right += static_cast<std::size_t>(answer.gate == Gate::match &&
                                        answer.match->place == answer.frame);
    }
  };
  for (const auto& seen : query) count(detector.step(seen).answers);
  count(detector.finish());
  std::printf("right %zu\n", right);
  EXPECT_GT(right, 190U);
}

TEST(Keyframes, OfARobotThatStandsAreNoneHoweverMuchNoiseThereIs) {
  // Values of the drive deviate by .5, and those of the noise by .14 and .29.
  constexpr std::size_t size = 1024;
  for (const float noise : {0.5F, 1.0F}) {
    SCOPED_TRACE(noise);
    const Vectors way = test::way(4, 100, noise, 1, size);
    // What stands is seen anew in each frame.
    Vectors drive = way;
    for (std::uint32_t visit = 2; visit < 202; ++visit) {
      drive.push_back(test::way(4, 100, noise, visit, size).back());
    }
    const Vectors goes_on = test::way(4, 160, noise, 1, size);
    drive.insert(drive.end(), goes_on.begin() + 100, goes_on.end());
    const std::vector<bool> are = keyframes_of(drive, variance_of(way));
    const auto keyframes = [&](std::size_t first, std::size_t last) {
      return std::count(are.begin() + static_cast<std::ptrdiff_t>(first),
                        are.begin() + static_cast<std::ptrdiff_t>(last), true);
    };
    EXPECT_EQ(keyframes(0, 100), 100);
    EXPECT_LE(keyframes(100, 300), 25);  // until a keyframe is old enough, and six in a row
    EXPECT_EQ(keyframes(300, 360), 60);
  }
}

TEST(FrameSteps, AreTheFramesWhereEachIsOne) {
  const Memory memory;
  FrameSteps steps = memory.steps(0, 0);
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    steps.take(true, something_new);
    EXPECT_EQ(steps.frame_of(frame), frame);
    EXPECT_EQ(steps.frames(), frame + 1);
  }
}

TEST(FrameSteps, LeaveOutFramesThatNeverCame) {
  const Memory memory;
  FrameSteps steps = memory.steps(8, 16);
  steps.take(true, something_new);   // frame 0
  steps.repeat();                    // 1
  steps.skip(2);                     // 2, 3
  steps.repeat();                    // 4
  steps.take(false, another_scene);  // 5
  steps.skip(4);                     // 6 to 9
  steps.pass(2, 4);
  steps.take(true, something_new);  // 10
  const auto frames_of = [&](std::uint64_t step) {
    std::vector<std::uint64_t> frames;
    steps.frames_of(step, [&](std::uint64_t frame, bool settled) {
      frames.push_back(frame);
      EXPECT_EQ(settled, step != 1);
    });
    return frames;
  };
  EXPECT_EQ(frames_of(0), (std::vector<std::uint64_t>{0, 1, 4}));
  EXPECT_EQ(frames_of(1), (std::vector<std::uint64_t>{5}));
  EXPECT_TRUE(frames_of(2).empty());
  EXPECT_EQ(steps.frame_of(2), 6U);
  EXPECT_EQ(steps.frame_of(3), 8U);
  EXPECT_EQ(frames_of(4), (std::vector<std::uint64_t>{10}));
  EXPECT_EQ(steps.frames(), 11U);
}

TEST(FrameSteps, MakeOneStopOfTwoWithAFrameBetween) {
  const Memory memory;
  FrameSteps steps = memory.steps(32, 64);
  // Steps of so many frames: 0 to 4 one each, 5 to 9, 10, 11 and 12, 13 to 17 one each.
  for (const std::size_t frames :
       std::array<std::size_t, 13>{1, 1, 1, 1, 1, 5, 1, 2, 1, 1, 1, 1, 1}) {
    steps.take(true, something_new);
    for (std::size_t i = 1; i < frames; ++i) steps.repeat();
  }
  for (std::uint64_t step = 0; step < 13; ++step) {
    SCOPED_TRACE(step);
    const auto stop = steps.stop_at(step);
    ASSERT_EQ(stop.has_value(), step >= 2 && step <= 8)
        << "at most three steps beside the long one";
    if (!stop) continue;
    EXPECT_EQ(stop->came, 5U);
    EXPECT_EQ(stop->left, 13U);
    EXPECT_TRUE(stop->seen_to_come);
  }
}

TEST(FrameSteps, MakeAStopAsLongBeforeWhereItStoodForLongAsAfterIt) {
  for (const bool before : {true, false}) {
    const Memory memory;
    FrameSteps steps = memory.steps(64, 128);
    std::uint64_t frames = 0;
    const auto stand = [&](std::uint64_t count) {
      steps.take(true, something_new);
      for (std::uint64_t frame = 1; frame < count; ++frame) steps.repeat();
      frames += count;
    };
    for (int step = 0; step < 15; ++step) stand(1);
    for (int step = 0; before && step < 10; ++step) stand(2);
    const std::uint64_t long_one = before ? 25 : 15;
    stand(6);
    for (int step = 0; !before && step < 10; ++step) stand(2);
    const std::uint64_t end = frames;
    for (int step = 0; step < 5; ++step) stand(1);
    const auto stop = steps.stop_at(long_one);
    ASSERT_TRUE(stop);
    EXPECT_EQ(stop->came, 15U);
    EXPECT_EQ(stop->left, end);
  }
}

TEST(FrameSteps, AreNoStopsWhereFramesComeTwice) {
  const Memory memory;
  FrameSteps steps = memory.steps(32, 64);
  for (std::size_t step = 0; step < 20; ++step) {
    steps.take(true, something_new);
    steps.repeat();
    EXPECT_FALSE(steps.stop_at(step)) << step;
  }
}

TEST(FrameSteps, AreIsolatedBetweenTwoCuts) {
  const Memory memory;
  FrameSteps steps = memory.steps(16, 32);
  for (const FrameSteps::Shows shows :
       {something_new, another_scene, another_scene, something_new, another_scene}) {
    steps.take(true, shows);
  }
  steps.skip(1);  // a frame that never came,
  steps.pass(1, 1);
  steps.take(true, the_same);  // and what it may have shown
  for (std::uint64_t step = 0; step < 7; ++step) {
    EXPECT_EQ(steps.is_isolated(step), step == 1) << step;
    EXPECT_EQ(steps.frame_of(step), step);
    EXPECT_EQ(steps.repeats(step), step >= 4) << step;
  }
  steps.take(true, another_scene);
  for (std::uint64_t step = 4; step < 7; ++step) EXPECT_TRUE(steps.is_isolated(step)) << step;
}

/// The answers of a drive by frame, each of which must have one, in time.
std::map<std::uint64_t, Answer> answers_of(const Vectors& drive, const MatcherConfig& config,
                                           PlaceMap& map) {
  Detector detector(config, map);
  std::map<std::uint64_t, Answer> given;
  std::uint64_t frame = 0;
  for (const auto& descriptor : drive) {
    const FrameReport report = detector.step(descriptor);
    EXPECT_EQ(report.newest, frame++);
    for (const Answer& answer : report.answers) {
      EXPECT_TRUE(given.emplace(answer.frame, answer).second) << answer.frame;
      EXPECT_LE(report.newest - answer.frame, config.patience);
    }
    EXPECT_EQ(report.frame.has_value(), !report.answers.empty());
    if (report.frame) {
      EXPECT_EQ(*report.frame, report.answers.back().frame);
    }
  }
  for (const Answer& answer : detector.finish()) {
    EXPECT_TRUE(given.emplace(answer.frame, answer).second) << answer.frame;
  }
  EXPECT_EQ(given.size(), drive.size());
  return given;
}

/// How many are accepted. @param most frames that a place may be off; all have to be right
std::size_t accepted(const std::map<std::uint64_t, Answer>& answers, std::uint64_t most) {
  std::size_t count = 0;
  for (const auto& [frame, answer] : answers) {
    if (answer.gate != Gate::match) continue;
    ++count;
    EXPECT_LE(std::max(frame, answer.match->place) - std::min(frame, answer.match->place), most)
        << frame;
  }
  return count;
}

// Of frames that differ hardly from one to the next none tells anything; of keyframes each does.
TEST(Keyframes, LetASlowRobotKnowWhereItIs) {
  constexpr std::size_t slower = 6;
  const Vectors known = test::slowly(test::way(1, 300, 0.3F, 1), slower, 1);
  const Vectors seen = test::slowly(test::way(1, 300, 0.3F, 2), slower, 2);
  for (const bool keyframes : {true, false}) {
    MatcherConfig config;
    config.keyframes = keyframes;
    PlaceMap map = map_of(known, config);
    const auto answers = answers_of(seen, config, map);
    if (keyframes) {
      EXPECT_LT(map.size(), known.size() / 2) << "less memory, too";
      EXPECT_GT(accepted(answers, 10 * slower), seen.size() / 2);
    } else {
      EXPECT_EQ(map.size(), known.size());
      EXPECT_LT(accepted(answers, 10 * slower), seen.size() / 4);
    }
  }
}

TEST(Keyframes, LetARobotThatStandsForLongGoOnKnowing) {
  const Vectors known = test::way(1, 300, 0.3F, 1);
  const Vectors seen = test::way(1, 300, 0.3F, 2);
  constexpr std::size_t at = 150;
  constexpr std::size_t stop = 400;
  const Vectors stops = with_stop(seen, at, stop);
  MatcherConfig config;
  PlaceMap map = map_of(known, config);
  const auto answers = answers_of(stops, config, map);
  std::size_t behind = 0;
  for (std::uint64_t frame = at + stop; frame < stops.size(); ++frame) {
    const Answer& answer = answers.at(frame);
    if (answer.gate != Gate::match) continue;
    ++behind;
    EXPECT_NEAR(static_cast<double>(answer.match->place), static_cast<double>(frame - stop), 5.0);
  }
  EXPECT_GT(behind, 120U) << "of 150";
}

// The answer of the keyframe that the robot stands at has been given long ago; those of the frames
// that show the same have not.
TEST(Keyframes, AreAcceptedFromWhatHoldsWhenTheirAnswersAreGiven) {
  const Vectors known = test::way(1, 300, 0.3F, 1);
  const Vectors stops = with_stop(test::way(1, 300, 0.3F, 2), 150, 400);
  MatcherConfig config;
  PlaceMap map = map_of(known, config);
  Detector detector(config, map);
  std::array<std::size_t, 2> accepted{};
  std::array<std::size_t, 2> refused{};
  float least = config.min_probability;
  for (std::size_t frame = 0; frame < 500; ++frame) {
    if (frame >= 300 && frame % 25 == 0) {
      least = frame % 50 == 0 ? 1.0F : 0.5F;
      detector.accept_from(least);
    }
    for (const Answer& answer : detector.step(stops[frame]).answers) {
      EXPECT_EQ(answer.gate == Gate::match, answer.match && answer.probability >= least)
          << answer.frame << " with frame " << frame;
      if (frame < 300) continue;
      const bool all = least == 1.0F;
      (answer.gate == Gate::match ? accepted : refused)[all ? 1 : 0] += 1;
    }
  }
  EXPECT_GE(accepted[0], 100U);
  EXPECT_EQ(refused[0], 0U);
  EXPECT_GE(accepted[1] + refused[1], 100U);
  EXPECT_GE(refused[1], 100U) << "nothing is that sure";
}

/// A robot that is carried to another place in one frame, and stands there.
TEST(Keyframes, LetNoRobotThatWasCarriedAwayAndStandsBelieveItsLastPlace) {
  const Vectors known = test::way(1, 300, 0.3F, 1);
  const Vectors seen = test::way(1, 300, 0.3F, 2);
  Vectors drive(seen.begin(), seen.begin() + 150);
  const Vectors elsewhere = test::way(9, 1, 0.3F, 1);
  constexpr std::size_t stop = 400;
  for (std::size_t i = 0; i < stop; ++i) drive.push_back(elsewhere.front());
  MatcherConfig config;
  PlaceMap map = map_of(known, config);
  const auto answers = answers_of(drive, config, map);
  EXPECT_GT(accepted(answers, 5), 100U);
  for (std::uint64_t frame = 150; frame < drive.size(); ++frame) {
    EXPECT_NE(answers.at(frame).gate, Gate::match) << frame;
  }
}

// Where each frame shows something else, any stop is behind a cut. What it shows is told apart from
// what a robot sees that was carried away with the first frame of its stop.
TEST(Keyframes, LetARobotStandWhereEachFrameIsNew) {
  constexpr float nothing_kept = 0.0F;
  constexpr std::size_t at = 150;
  constexpr std::size_t stop = 400;
  const Vectors known = test::way(1, 300, 0.3F, 1, 256, nothing_kept);
  const Vectors seen = test::way(1, 300, 0.3F, 2, 256, nothing_kept);
  const std::vector<float> elsewhere = test::way(9, 1, 0.3F, 1, 256, nothing_kept).front();
  for (const bool carried : {false, true}) {
    Vectors drive(seen.begin(), seen.begin() + at);
    for (std::size_t i = 0; i < stop; ++i) drive.push_back(carried ? elsewhere : seen[at]);
    MatcherConfig config;
    PlaceMap map = map_of(known, config);
    const auto answers = answers_of(drive, config, map);
    for (std::uint64_t frame = at; frame < drive.size(); ++frame) {
      const Answer& answer = answers.at(frame);
      ASSERT_EQ(answer.gate == Gate::match, !carried) << frame;
      if (!carried) {
        EXPECT_EQ(answer.match->place, at) << frame;
      }
    }
  }
}

/// Rows that the belief moves on by while 20 frames show the same, and one that nobody knows.
/// @param pieces of the way that the robot drives before; it is carried from each to the next
std::int64_t moved_behind(const Vectors& known, const Vectors& seen,
                          std::initializer_list<CandidateRun> pieces,
                          const std::vector<float>& shown) {
  MatcherConfig config;
  PlaceMap map = map_of(known, config);
  Detector detector(config, map);
  const auto place_at = [&](const std::vector<float>& frame) {
    const FrameReport report = detector.step(frame);
    return report.now ? static_cast<std::int64_t>(report.now->place) : -1;
  };
  std::int64_t before = 0;
  for (const auto& [first, last] : pieces) {
    for (std::size_t row = first; row < last; ++row) before = place_at(seen[row]);
  }
  for (int i = 0; i < 20; ++i) static_cast<void>(place_at(shown));
  return place_at(test::way(8, 1, 0.3F, 1).front()) - before;
}

// One frame is all that is known of where it stands.
TEST(Keyframes, AreNotSureOfTheNewestFrameWhereTheRobotStandsBehindACut) {
  constexpr float nothing_kept = 0.0F;
  const Vectors known = test::way(1, 300, 0.3F, 1, 256, nothing_kept);
  const Vectors seen = test::way(1, 300, 0.3F, 2, 256, nothing_kept);
  MatcherConfig config;
  PlaceMap map = map_of(known, config);
  Detector detector(config, map);
  float now = 0.0F;
  const auto take = [&](const std::vector<float>& descriptor) {
    now = detector.step(descriptor).now.value().probability;
  };
  for (std::size_t i = 0; i < 150; ++i) take(seen[i]);
  EXPECT_GT(now, 0.99F);
  for (int i = 0; i < 10; ++i) {
    take(seen[149]);
    EXPECT_LE(now, 0.95F) << i;
  }
}

// Somebody may stand before the camera of a robot that drives on.
TEST(Keyframes, LetOnlyARobotThatMayBeHiddenDriveOnUnseen) {
  constexpr float nothing_kept = 0.0F;
  const Vectors known = test::way(1, 300, 0.3F, 1, 256, nothing_kept);
  const Vectors seen = test::way(1, 300, 0.3F, 2, 256, nothing_kept);
  const std::vector<float> somebody = test::way(9, 1, 0.3F, 1, 256, nothing_kept).front();
  EXPECT_GE(moved_behind(known, seen, {{0, 150}}, somebody), 10);
  // The first of the frames moves the belief on, and the one behind them.
  EXPECT_LE(moved_behind(known, seen, {{0, 150}}, seen[150]), 2) << "it shows its place";
  EXPECT_LE(moved_behind(known, seen, {{0, 80}, {150, 230}}, somebody), 2) << "after a jump";
  const Vectors near = test::way(1, 300, 0.3F, 1);
  const Vectors foreign = test::way(9, 20, 0.3F, 2);
  Vectors leaves(near.begin(), near.begin() + 150);
  leaves.insert(leaves.end(), foreign.begin(), foreign.end());
  EXPECT_LE(moved_behind(near, leaves, {{0, 169}}, leaves[169]), 2) << "behind no cut";
  constexpr std::size_t frames = 4;  // of a keyframe
  const Vectors slow = test::slowly(near, frames, 2);
  EXPECT_LE(moved_behind(slow, slow, {{0, 600}}, somebody), 3 * frames) << "in a dense drive";
}

// Of one frame nobody can tell whether the map has its place. Without a map it is new.
TEST(Keyframes, LetNoRobotThatIsSwitchedOnWhereItStandsBeNew) {
  const Vectors seen = test::way(1, 300, 0.3F, 2);
  constexpr std::size_t stop = 300;
  const Vectors drive = with_stop(seen, 0, stop);
  for (const bool has_map : {true, false}) {
    MatcherConfig config;
    if (!has_map) config.use = Use::close_loops;
    PlaceMap map = has_map ? map_of(test::way(1, 300, 0.3F, 1), config)
                           : PlaceMap(config, {drive.size(), drive.front().size()});
    const auto answers = answers_of(drive, config, map);
    const std::uint64_t early = stop - config.patience - 1;
    for (std::uint64_t frame = 0; frame < early; ++frame) {
      ASSERT_EQ(answers.at(frame).gate, has_map ? Gate::unsure : Gate::new_place) << frame;
    }
    EXPECT_EQ(answers.at(stop + 100).gate, has_map ? Gate::match : Gate::new_place);
  }
}

// Where drive and map both stood, the frames of the stop go by one for one.
TEST(Keyframes, TellWhichFrameOfAStopItWas) {
  constexpr std::size_t at = 150;
  constexpr std::size_t stop = 60;
  const Vectors known = with_stop(test::way(1, 300, 0.3F, 1), at, stop);
  const Vectors seen = with_stop(test::way(1, 300, 0.3F, 2), at, stop);
  MatcherConfig config;
  PlaceMap map = map_of(known, config);
  EXPECT_EQ(map.size(), 300U);
  EXPECT_EQ(map.stood(at), stop);
  for (std::size_t row = 0; row < map.size(); ++row) {
    const auto rows = map.stop_at(row);
    ASSERT_EQ(rows.has_value(), row + 3 >= at && row <= at + 3) << row;
    if (!rows) continue;
    EXPECT_EQ(rows->first, at);
    EXPECT_EQ(rows->last, at + 1);
  }
  std::size_t told = 0;
  for (const auto& [frame, answer] : answers_of(seen, config, map)) {
    if (answer.gate != Gate::match) continue;
    EXPECT_LE(std::max(frame, answer.match->frame()) - std::min(frame, answer.match->frame()), 3U)
        << frame;
    told += frame > at && frame <= at + stop ? 1 : 0;
  }
  EXPECT_EQ(told, stop);
}

// The same in one drive.
TEST(Keyframes, TellWhichFrameOfItsOwnStopItWas) {
  constexpr std::size_t at = 150;
  constexpr std::size_t stop = 60;
  constexpr std::size_t lap = 300 + stop;
  Vectors laps = with_stop(test::way(1, 300, 0.3F, 1), at, stop);
  const Vectors again = with_stop(test::way(1, 300, 0.3F, 2), at, stop);
  laps.insert(laps.end(), again.begin(), again.end());
  MatcherConfig config;
  config.use = Use::close_loops;
  PlaceMap map(config, {laps.size(), laps.front().size()});
  std::size_t told = 0;
  for (const auto& [frame, answer] : answers_of(laps, config, map)) {
    if (answer.gate != Gate::match) continue;
    const std::uint64_t is = answer.match->frame() + lap;
    EXPECT_LE(std::max(frame, is) - std::min(frame, is), 3U) << frame;
    told += frame > lap + at && frame <= lap + at + stop ? 1 : 0;
  }
  EXPECT_EQ(map.stood(at), stop);
  EXPECT_EQ(told, stop);
}

// A robot that stood has gone on meanwhile, or has not: what is seen next tells. Frames that cannot
// be read are answered at once all the same.
TEST(Keyframes, OfARobotThatStoodAreKnownOnceSomethingIsSeenAgain) {
  constexpr std::size_t at = 150;
  constexpr std::size_t stop = 60;
  const Vectors known = with_stop(test::way(1, 300, 0.3F, 1), at, stop);
  const Vectors seen = with_stop(test::way(1, 300, 0.3F, 2), at, stop);
  struct Case {
    const char* which;
    std::size_t first, last, every;
    std::size_t least;  // that are told of those that are seen
  };
  constexpr std::size_t all = 360;
  const std::array cases{
      Case{"every third of the stop", at + 2, at + stop - 1, 3, all - 20 - 3},
      Case{"the stop, but for its ends", at + 2, at + stop - 2, 1, all - 57 - 3},
      Case{"as it leaves", at + stop + 1, at + stop + 12, 1, all - 12 - 3},
      Case{"for long, as it leaves", at + stop + 1, at + stop + 45, 1, at},
  };
  for (const bool never_came : {false, true}) {
    for (const Case& lost_are : cases) {
      SCOPED_TRACE(lost_are.which);
      MatcherConfig config;
      // More on end that never came are not counted.
      const bool many = lost_are.last - lost_are.first > config.sequence_length;
      if (never_came && lost_are.every == 1 && many) continue;
      PlaceMap map = map_of(known, config);
      Detector detector(config, map);
      std::size_t told = 0;
      std::size_t unread = 0;
      const auto take = [&](std::span<const Answer> answers) {
        for (const Answer& answer : answers) {
          unread += answer.gate == Gate::frame_error ? 1 : 0;
          if (answer.gate != Gate::match) continue;
          ++told;
          EXPECT_NEAR(static_cast<double>(answer.match->frame()), static_cast<double>(answer.frame),
                      3.0);
        }
      };
      std::size_t lost = 0;
      for (std::size_t frame = 0; frame < seen.size(); ++frame) {
        const bool is_lost = frame >= lost_are.first && frame <= lost_are.last &&
                             (frame - lost_are.first) % lost_are.every == 0;
        lost += is_lost ? 1 : 0;
        if (is_lost && never_came) {
          detector.skip(1);
          continue;
        }
        const FrameReport report =
            detector.step(is_lost ? std::span<const float>() : std::span(seen[frame]));
        EXPECT_EQ(report.newest, frame);
        EXPECT_EQ(report.now.has_value(), !is_lost) << frame;
        take(report.answers);
        if (!is_lost) continue;
        EXPECT_EQ(report.gate, Gate::frame_error);
        EXPECT_EQ(report.frame, frame);
      }
      take(detector.finish());
      EXPECT_EQ(unread, never_came ? 0 : lost);
      EXPECT_GE(told, lost_are.least) << never_came;
    }
  }
}

// Where frames follow each other closely, those that cannot be read are on the way to the next
// keyframe, and none themselves.
TEST(Keyframes, OfASlowRobotAreAsUsualWhereFramesCannotBeRead) {
  constexpr std::size_t slower = 6;
  Vectors laps = test::slowly(test::way(1, 200, 0.3F, 1), slower, 1);
  const std::size_t lap = laps.size();
  const Vectors again = test::slowly(test::way(1, 200, 0.3F, 2), slower, 2);
  laps.insert(laps.end(), again.begin(), again.end());
  std::size_t read = 0;
  for (std::size_t frame = 0; frame < laps.size(); ++frame) {
    const bool can_be_read = frame % 8 < 4;
    if (!can_be_read) laps[frame].clear();
    read += can_be_read && frame >= lap ? 1 : 0;
  }
  MatcherConfig config;
  config.use = Use::close_loops;
  PlaceMap map(config, {laps.size(), laps.front().size()});
  std::size_t found = 0;
  for (const auto& [frame, answer] : answers_of(laps, config, map)) {
    if (answer.gate != Gate::match) continue;
    ++found;
    EXPECT_NEAR(static_cast<double>(answer.match->frame() + lap), static_cast<double>(frame),
                5.0 * slower);
  }
  EXPECT_LT(map.size(), laps.size() / 3);
  EXPECT_GT(found, read / 2);
}

// Who comes to a stop is at its beginning, even if nothing is known of him before, and frames may
// be asked for in any order.
TEST(StopFrames, GoByTogetherInDriveAndMap) {
  constexpr std::size_t at = 150;
  constexpr std::size_t length = 60;
  MatcherConfig config;
  const PlaceMap map = map_of(with_stop(test::way(1, 300, 0.3F, 1), at, length), config);
  // The robot stands from its 20th frame to its 80th.
  const FrameSteps::Stop stop{20, true, 81};
  const auto told = [&](const StopFrames& frames, std::uint64_t frame, std::uint64_t place) {
    const StopFrame found = frames.at(map, stop, frame, place);
    return found.place + found.stood;
  };
  StopFrames frames;
  frames.begin();
  EXPECT_EQ(told(frames, 19, at), at) << "on its way there";
  EXPECT_EQ(told(frames, 19, at - 1), at - 1);
  EXPECT_EQ(told(frames, 19, at + length + 2), at) << "two places behind it";
  EXPECT_EQ(told(frames, 80, at), at + 60);
  EXPECT_EQ(told(frames, 50, at), at + 30) << "before the one that was asked for";
  EXPECT_EQ(told(frames, 20, at + length + 3), at) << "three places behind it";
  EXPECT_EQ(told(frames, 30, at + length + 4), at + length + 4) << "four";
  EXPECT_EQ(told(frames, 82, at + length + 2), at + length + 2);
  const FrameSteps::Stop shorter{20, true, 40};
  EXPECT_EQ(frames.at(map, shorter, 40, at + length + 1).place, at + length + 1) << "it drove on";
  const FrameSteps::Stop nearly{20, true, 70};
  EXPECT_EQ(frames.at(map, nearly, 70, at + length + 1).stood, 50U) << "it hardly moved";
  frames.was_at(85, at + length + 5);
  EXPECT_EQ(told(frames, 50, at), at + 30) << "what came later";
  const StopFrame moves = frames.at(map, std::nullopt, 50, at);
  EXPECT_EQ(moves.place, at);
  EXPECT_EQ(moves.stood, 0U) << "only the map's drive stood";
  StopFrames known;
  known.begin();
  known.was_at(18, at - 4);
  EXPECT_EQ(told(known, 30, at), at + 8) << "it was four places before, two frames before";
  const FrameSteps::Stop carried{20, false, 81};
  EXPECT_EQ(frames.at(map, carried, 80, at).stood, length) << "counted back";
}

/// Each frame twice, as of a camera of 15 frames a second that is read at 30, or every second one;
/// in the map, in the drive, or in both: no stop that frames could be counted on through.
TEST(StopFrames, AreNotTakenForFramesThatComeTwice) {
  const auto stutters = [](const Vectors& drive, std::size_t every) {
    Vectors seen;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      seen.push_back(drive[i]);
      if (every > 0 && i % every == 0) seen.push_back(drive[i]);
    }
    return seen;
  };
  const auto frame_of = [](std::size_t of_the_way, std::size_t every) {
    return every == 0 ? of_the_way : of_the_way + (of_the_way + every - 1) / every;
  };
  for (std::size_t twice_then = 0; twice_then < 3; ++twice_then) {
    for (std::size_t twice_now = 0; twice_now < 3; ++twice_now) {
      SCOPED_TRACE(std::to_string(twice_then) + " " + std::to_string(twice_now));
      MatcherConfig config;
      PlaceMap map = map_of(stutters(test::way(1, 300, 0.3F, 1), twice_then), config);
      const auto answers = answers_of(stutters(test::way(1, 300, 0.3F, 2), twice_now), config, map);
      std::size_t right = 0;
      for (std::size_t i = 0; i < 300; ++i) {
        const Answer& answer = answers.at(frame_of(i, twice_now));
        if (answer.gate != Gate::match) continue;
        const auto frame = static_cast<std::int64_t>(answer.match->frame());
        const auto wanted = static_cast<std::int64_t>(frame_of(i, twice_then));
        EXPECT_LE(std::abs(frame - wanted), 6) << i;
        ++right;
      }
      EXPECT_GT(right, 250U);
    }
  }
}

/// It is carried to a picture that looks like the place it would come to next, stands there, and is
/// carried back to the way. Where it never was carried away before, the picture is believed.
TEST(Keyframes, LetNoRobotThatIsCarriedAboutBelieveInAPictureAlone) {
  const Vectors known = test::way(1, 400, 0.3F, 1);
  const Vectors seen = test::way(1, 400, 0.3F, 2);
  const Vectors foreign = test::way(9, 1, 0.3F, 1);
  constexpr std::size_t stop = 30;
  for (const bool carried : {false, true}) {
    Vectors drive;
    const auto pass = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
      drive.insert(drive.end(), seen.begin() + first, seen.begin() + last);
    };
    if (carried) pass(240, 300);
    if (carried) pass(140, 200);
    pass(0, 60);
    const std::size_t stands = drive.size();
    // Half of what it would see, and half of what it never saw.
    Vectors picture{seen[60]};
    for (std::size_t d = 0; d < picture.front().size(); ++d) {
      picture.front()[d] += 1.1F * foreign.front()[d];
    }
    for (std::size_t i = 0; i < stop; ++i) drive.push_back(test::unit(picture).front());
    pass(61, 120);
    MatcherConfig config;
    for (const bool one_is_lost : {false, true}) {
      PlaceMap map = map_of(known, config);
      Detector detector(config, map);
      std::size_t accepted = 0;
      const auto take = [&](std::span<const Answer> answers) {
        for (const Answer& answer : answers) {
          const bool stood = answer.frame >= stands && answer.frame < stands + stop;
          accepted += stood && answer.gate == Gate::match ? 1 : 0;
        }
      };
      for (std::size_t frame = 0; frame < drive.size(); ++frame) {
        if (one_is_lost && frame == stands + stop / 2) {
          detector.skip(1);
        } else {
          take(detector.step(drive[frame]).answers);
        }
      }
      take(detector.finish());
      if (carried) {
        EXPECT_EQ(accepted, 0U) << one_is_lost;
      } else {
        EXPECT_GE(accepted, stop - 1) << one_is_lost;
      }
    }
  }
}

TEST(Keyframes, AloneBecomePlacesAndKeepTheirNumbers) {
  Vectors drive = test::slowly(test::way(1, 300, 0.3F, 1), 6, 1);
  MatcherConfig config;
  config.use = Use::close_loops;
  PlaceMap map(config, {drive.size(), drive.front().size()});
  static_cast<void>(answers_of(drive, config, map));
  EXPECT_LT(map.size(), drive.size() / 2);
  for (std::size_t row = 0; row < map.size(); ++row) {
    EXPECT_EQ(map.order().number(row), map.order().frame(row));
  }
  EXPECT_GT(map.order().number(map.size() - 1) + 20, drive.size());
}

// Frames that cannot be read, that never came, and stops, in any order. How frames are counted does
// not depend on which of them are keyframes.
TEST(Keyframes, LeaveEachFrameThatCameOneAnswer) {
  std::printf("seed 7\n");
  std::vector<std::uint64_t> counts;
  const Vectors slow = test::slowly(test::way(1, 200, 0.3F, 1), 5, 1);
  for (const Use use : {Use::localise, Use::close_loops}) {
    for (const std::size_t patience : {0U, 3U, 120U}) {
      MatcherConfig config;
      config.use = use;
      config.patience = patience;
      PlaceMap map = use == Use::localise
                         ? map_of(slow, config)
                         : PlaceMap(config, {3 * slow.size(), slow.front().size()});
      Detector detector(config, map);
      std::mt19937 random(7);
      std::vector<std::uint64_t> newest;
      std::map<std::uint64_t, int> came;
      const auto take = [&](std::span<const Answer> answers) {
        for (const Answer& answer : answers) --came[answer.frame];
      };
      std::uint64_t counted = 0;
      for (std::size_t at = 0; at < slow.size(); ++at) {
        const auto dice = random() % 40;
        const std::uint64_t lost = dice == 0 ? 1 + random() % 12 : 0;
        const std::uint64_t calls = 1 + random() % 40;
        for (std::uint64_t call = 0; call < calls; ++call) detector.skip(lost);
        const std::size_t times = dice == 1 ? 1 + random() % 150 : 1;
        for (std::size_t i = 0; i < times; ++i) {
          const FrameReport report = detector.step(dice == 2 ? std::span<const float>() : slow[at]);
          EXPECT_GE(report.newest, counted);
          counted = report.newest + 1;
          newest.push_back(report.newest);
          ++came[report.newest];
          take(report.answers);
          for (const Answer& answer : report.answers) {
            EXPECT_LE(report.newest - answer.frame, patience + lost * calls);
          }
        }
      }
      take(detector.finish());
      if (counts.empty()) counts = newest;
      EXPECT_EQ(newest, counts);
      for (const auto& [frame, balance] : came) EXPECT_EQ(balance, 0) << frame;
    }
  }
}

}  // namespace
}  // namespace seqloop
