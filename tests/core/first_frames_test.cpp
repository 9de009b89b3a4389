// SPDX-License-Identifier: MIT
// A trace that began among a drive's first frames is followed back to where the drive began.
#include "seqloop/detail/first_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/seen.hpp"
#include "core/ways.hpp"

namespace seqloop {
namespace {

constexpr std::size_t frames = FirstFrames::most;

oracle::Vectors known_way(std::size_t without) {
  oracle::Vectors rows = test::way(1, 200, 0.3F, 1);
  rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(without));
  return rows;
}

/// A drive past a known way, from this row of it on.
struct FirstOfADrive {
  Seen seen;
  FirstFrames first;
  std::vector<Scene> scenes;
  std::vector<BeliefTraces::Step> trace;

  /// @param unread  frame that could not be read; `frames`: none
  /// @param without first rows that the map does not have
  explicit FirstOfADrive(std::size_t from, std::size_t unread = frames, std::size_t without = 0)
      : seen(known_way(without), {}), first(seen.memory.arena, true), trace(120) {
    const oracle::Vectors query = test::way(1, 200, 0.3F, 2);
    SceneGauge gauge(seen.memory.arena, true);
    std::size_t sketches = 0;
    for (std::size_t i = 0; i < frames + 5; ++i) {
      const SceneView view = seen.take(query[from + i]);
      Scene scene = *gauge.look(view, sketches);
      if (i == unread) {
        first.repeat(1);
        scene = scenes.back();
        scene.novelty = scene.change = 0.0;
      } else {
        first.take(view, scene);
      }
      scenes.push_back(scene);
    }
  }

  /// The row that the trace began with, at this frame. @return frames of it then
  std::size_t follow(std::size_t began, std::size_t row, std::size_t& sketches) {
    const std::size_t newest = frames + 4;
    const std::size_t count = newest + 1 - began;
    for (std::size_t back = 0; back < count; ++back) {
      trace[back] = {row + (count - 1 - back), 1.0, 0.5, 0.5};
    }
    return first.follow(seen.map, trace, count, newest, sketches);
  }
};

/// Section 6.6 of src/README.md, written down anew.
std::vector<BeliefTraces::Step> followed(const FirstOfADrive& drive, std::size_t began,
                                         std::size_t row) {
  const Seen& seen = drive.seen;
  const DescriptorRows& queries = seen.queries.rows();
  std::vector<BeliefTraces::Step> steps;
  for (std::size_t frame = began; frame-- > 0;) {
    const Scene& scene = drive.scenes[frame];
    const auto x = [&](std::size_t there, std::size_t t) {
      return seen.map.rows().look_closely(queries, seen.queries.row_of(t),
                                          seen.map.order().slot(there)) /
             1024.0;
    };
    const std::array<double, 3> by =
        scene.novelty > 0.02 ? std::array{0.06, 0.88, 0.06} : std::array{0.45, 0.40, 0.15};
    double best = -1e9;
    std::size_t from = row;
    for (std::size_t i = 0; i < 3 && i <= row; ++i) {
      const double likely = std::log(by[i]) + (scene.mean - x(row - i, frame)) / scene.deviation;
      if (likely > best) from = row - i;
      best = std::max(best, likely);
    }
    row = from;
    double contrast = 0.0;
    if (frame >= 8) {
      double around = 2.0 * x(row, frame - 8);
      double weight = 2.0;
      for (const std::size_t other : {row - 8, row + 8}) {
        if (other >= seen.map.size()) continue;
        around += x(other, frame);
        weight += 1.0;
      }
      contrast = (around / weight - x(row, frame)) / scene.deviation;
    }
    const double z = (scene.mean - x(row, frame)) / scene.deviation;
    const double l = std::clamp(z + 0.7 * contrast - scene.bias, -1.5, 3.0);
    steps.push_back({row, scene.novelty * l, scene.novelty, scene.change});
  }
  return steps;
}

TEST(FirstFrames, ATraceIsFollowedBackToTheFirst) {
  std::size_t sketches = 0;
  for (const std::size_t from : {0U, 3U, 60U}) {
    FirstOfADrive drive(from);
    for (const std::size_t began : {1U, 7U, 20U}) {
      SCOPED_TRACE(testing::Message() << "from " << from << ", began " << began);
      const std::size_t count = frames + 5 - began;
      ASSERT_EQ(drive.follow(began, from + began, sketches), frames + 5);
      const std::vector<BeliefTraces::Step> wanted = followed(drive, began, from + began);
      for (std::size_t i = 0; i < began; ++i) {
        const BeliefTraces::Step& step = drive.trace[count + i];
        EXPECT_EQ(step.row, wanted[i].row) << i;
        EXPECT_NEAR(step.gain, wanted[i].gain, 1e-12) << i;
        EXPECT_EQ(step.novelty, wanted[i].novelty) << i;
        EXPECT_EQ(step.change, wanted[i].change) << i;
      }
      // It is where the robot was.
      EXPECT_EQ(drive.trace[count + began - 1].row, from);
    }
  }
}

TEST(FirstFrames, OneThatCouldNotBeReadStandsStill) {
  std::size_t sketches = 0;
  FirstOfADrive drive(50, 4);
  ASSERT_EQ(drive.follow(9, 59, sketches), frames + 5);
  const BeliefTraces::Step& unread = drive.trace[frames + 5 - 1 - 4];
  EXPECT_EQ(unread.novelty, 0.0);
  EXPECT_EQ(unread.gain, 0.0);
}

TEST(FirstFrames, NothingIsFollowedBeyondThem) {
  std::size_t sketches = 0;
  FirstOfADrive drive(30);
  const std::size_t all = frames + 5;
  EXPECT_EQ(drive.follow(0, 30, sketches), all) << "it began with the first";
  EXPECT_EQ(drive.follow(frames + 1, 51, sketches), all - frames - 1) << "it began later";
  EXPECT_EQ(sketches, 0U);
  drive.first.restart();
  EXPECT_EQ(drive.follow(7, 37, sketches), all - 7) << "there are none";
  // A drive that is long under way when it is first looked at has none either.
  const SceneView view{&drive.seen.queries,  &drive.seen.map, &drive.seen.proposals, frames + 4, 0,
                       drive.seen.map.size()};
  drive.first.take(view, drive.scenes.back());
  EXPECT_EQ(drive.first.follow(drive.seen.map, drive.trace, 3, frames + 7, sketches), 3U);
  EXPECT_EQ(sketches, 0U);
}

TEST(FirstFrames, AreFollowedAsFarAsThereIsRoom) {
  std::size_t sketches = 0;
  FirstOfADrive drive(30);
  const std::size_t count = frames + 5 - 7;
  for (const std::size_t room : {0U, 6U, 7U, 8U}) {
    std::vector<BeliefTraces::Step> trace(count + room, {40, 1.0, 0.5, 0.5});
    EXPECT_EQ(drive.first.follow(drive.seen.map, trace, count, frames + 4, sketches),
              count + std::min<std::size_t>(room, 7));
  }
}

TEST(FirstFrames, DoNotFollowARobotThatCameFromBeforeTheMap) {
  std::size_t sketches = 0;
  constexpr std::size_t all = frames + 5;
  for (const std::size_t before : {0U, 2U, 7U, 9U}) {
    SCOPED_TRACE(before);
    FirstOfADrive drive(0, frames, before);
    EXPECT_EQ(drive.follow(15, 15 - before, sketches), before <= 2 ? all : all - 15);
  }
}

TEST(FirstFrames, CompareNoMoreSketchesThanTheySay) {
  FirstOfADrive drive(60);
  for (std::size_t began = 0; began <= frames + 3; ++began) {
    std::size_t sketches = 0;
    static_cast<void>(drive.follow(began, 60 + began, sketches));
    EXPECT_LE(sketches, FirstFrames::most_sketches);
    if (began != frames) continue;
    EXPECT_GT(sketches, FirstFrames::most_sketches * 7 / 10);
  }
}

}  // namespace
}  // namespace seqloop
