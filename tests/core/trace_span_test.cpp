// SPDX-License-Identifier: MIT
// The smoother against the sum over all that it sums up, and what a cut does to it.
#include "seqloop/detail/trace_span.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

/// Of all ways to come onto a trace, leave it and come back, the share that is on it at a frame:
/// summed up from the first frame on for each of them.
TEST(TraceSpan, IsTheSumOverAllWays) {
  std::mt19937 random(7);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int round = 0; round < 100; ++round) {
    const bool loops = round >= 50;
    TestArena memory;
    TraceSpan span(memory.arena, loops ? Use::close_loops : Use::localise, 40);
    const std::size_t frames = 1 + random() % 40;
    const double before = round == 0 ? 0.0 : share();
    const double usual = share();
    const double jumps = loops || round % 3 == 0 ? 0.0 : 0.2 * share();
    std::vector<BeliefTraces::Step> trace;
    // So much is gained and lost that it comes back in some rounds.
    for (std::size_t i = 0; i < frames; ++i) {
      trace.push_back({i, 16.0 * share() - 8.0, share(), share(), 0.0, random() % 2 == 0});
      trace.back().besides = 4.0 * share() - 2.0;
    }
    const std::size_t asked = 1 + random() % frames;
    // Frames are counted from the oldest. One that has changed wholly is a cut in every other
    // drive.
    const double often = round % 2 == 0 ? 0.2 : 0.4;
    const auto step_of = [&](std::size_t i) { return trace[frames - 1 - i]; };
    const auto is_cut = [&](std::size_t i) { return round % 2 == 0 && step_of(i).change > 0.6; };
    double gained = 0.0;
    double novelty = 0.0;
    for (const BeliefTraces::Step& step : trace) {
      gained += step.gain + step.besides;
      novelty += step.novelty;
    }
    const double usually = loops ? std::max(usual, 0.7 * gained / novelty) : usual;
    std::vector<BeliefTraces::Step> less = trace;
    span.ask(less, usual);
    const auto found = span.find(less, before, usual, often, jumps, asked);
    ASSERT_EQ(found.size(), asked);
    // How likely a frame is, in a state, after that of the frame before.
    enum State : std::size_t { fresh, on, gone };
    const auto seen = [&](std::size_t i, State state) {
      const auto step = step_of(i);
      const double asked_of_it = usually * step.novelty;
      if (state == on) return std::exp(step.gain + step.besides - asked_of_it);
      if (state == fresh) return 1.0;
      if (loops) {
        return std::exp(std::min(0.0, (step.elsewhere ? 2.0 * step.novelty : 0.0) - asked_of_it));
      }
      // Half as much is usual where it was left.
      return 1.0 / (1.0 + 0.5 * usual * step.novelty);
    };
    const auto moves = [&](std::size_t i, State from, State to) {
      if (i == 0) return from == to ? 1.0 : 0.0;
      const double begins = is_cut(i) ? 0.9 : loops ? 0.001 : 0.01;
      const double ends = is_cut(i) && !loops ? 0.95 : 0.001 + jumps;
      const double returns = loops ? 1e-10 : 1e-5;
      const std::array<std::array<double, 3>, 3> chances{
          {{1.0 - begins, begins, 0.0}, {0.0, 1.0 - ends, ends}, {0.0, returns, 1.0 - returns}}};
      return chances[from][to];
    };
    // How likely all frames are: of all ways, or those that are on the trace at one of them.
    struct Likely {
      double still;
      double left;
    };
    const auto likely = [&](std::size_t on_at) {
      std::array<double, 3> ways{std::max(1.0 - before, std::min(1.0, 10.0 * jumps)), 1.0, 0.0};
      for (std::size_t i = 0; i < frames; ++i) {
        std::array<double, 3> next{};
        for (const State to : {fresh, on, gone}) {
          for (const State from : {fresh, on, gone}) {
            next[to] += ways[from] * moves(i, from, to);
          }
          next[to] *= i == on_at && to != on ? 0.0 : seen(i, to);
        }
        ways = next;
      }
      // At the newest frame of a drive that closes loops none has been left.
      if (loops) return Likely{ways[fresh] + ways[on], ways[on]};
      // That it is left with the frame to come, at the latest.
      const double left = 0.001 + jumps;
      return Likely{ways[fresh] + ways[on] + ways[gone], left * ways[on] + ways[gone]};
    };
    const Likely all = likely(frames);
    for (std::size_t i = frames - asked; i < frames; ++i) {
      const Likely on_it = likely(i);
      EXPECT_NEAR(found[frames - 1 - i].still, on_it.still / all.still, 1e-9);
      EXPECT_NEAR(found[frames - 1 - i].left, on_it.left / all.left, 1e-9);
    }
  }
}

/// A robot that was carried away, and put back further along the trace.
TEST(TraceSpan, IsLeftWhereManyFramesSayMuchAgainstIt) {
  TestArena memory;
  TraceSpan span(memory.arena, Use::localise, 80);
  for (const double gain : {-0.1, -1.0}) {
    SCOPED_TRACE(gain);
    std::vector<BeliefTraces::Step> trace(20, {0, 1.0, 0.5, 0.5});
    trace.resize(50, {0, gain, 0.5, 0.5});
    trace.resize(70, {0, 1.0, 0.5, 0.5});
    const auto on = span.find(trace, 0.0, 0.0, 0.5, 0.0, trace.size());
    EXPECT_EQ(on[35].still > 0.99, gain > -0.5) << on[35].still;
    EXPECT_EQ(on[35].still < 0.01, gain < -0.5) << on[35].still;
    EXPECT_GT(on[10].still, 0.99);
    EXPECT_GT(on[60].still, 0.99);
  }
}

/// A robot that leaves a road, goes by one beside it, and comes back onto the first one. What the
/// other one shows has to be very unlike, or the belief of the time somewhere else.
TEST(TraceSpan, ClosingLoopsItIsLeftBetweenFramesThatAreOnIt) {
  TestArena memory;
  TraceSpan span(memory.arena, Use::close_loops, 100);
  constexpr double usual = 0.1;
  constexpr double novelty = 0.5;
  struct Between {
    double gain;
    bool elsewhere;
    bool is_left;
  };
  for (const auto& [gain, elsewhere, is_left] :
       {Between{0.3, false, false}, Between{0.3, true, false}, Between{-0.4, false, false},
        Between{-0.4, true, true}, Between{-1.2, false, true}}) {
    SCOPED_TRACE(std::to_string(gain) + (elsewhere ? ", elsewhere" : ""));
    std::vector<BeliefTraces::Step> trace(20, {0, 2.0, 0.5, 0.5});
    trace.resize(70, {0, gain, 0.5, 0.5, 0.0, elsewhere});
    trace.resize(90, {0, 2.0, 0.5, 0.5});
    span.ask(trace, usual);
    const auto on = span.find(trace, 1.0, usual, novelty, 0.0, trace.size());
    EXPECT_EQ(on[45].still < 0.01, is_left) << on[45].still;
    EXPECT_EQ(on[45].still > 0.99, !is_left) << on[45].still;
    EXPECT_GT(on[10].still, 0.99);
    EXPECT_GT(on[80].still, 0.99);
  }
}

TEST(TraceSpan, BeginsAndEndsWithACut) {
  TestArena memory;
  TraceSpan span(memory.arena, Use::localise, 40);
  // On the trace between the cuts at frames 10 and 20, newest first.
  std::vector<BeliefTraces::Step> trace;
  for (std::size_t i = 0; i < 30; ++i) {
    const bool cut = i == 9 || i == 19;
    const bool on = i > 9 && i <= 19;
    trace.push_back({0, on ? 0.3 : -0.1, 0.1, cut ? 0.615 : 0.1});
  }
  for (const double novelty : {0.1, 0.5}) {
    SCOPED_TRACE(novelty);
    const auto on = span.find(trace, 0.0, 0.0, novelty, 0.0, trace.size());
    const bool sees_cuts = novelty < 0.3;
    EXPECT_EQ(on[20].still < 0.1, sees_cuts) << on[20].still;
    EXPECT_EQ(on[19].still > 0.9, sees_cuts) << on[19].still;
    EXPECT_EQ(on[10].still > 0.9, sees_cuts) << on[10].still;
    EXPECT_EQ(on[9].still < 0.1, sees_cuts) << on[9].still;
  }
}

/// Somebody walks past the camera for ten frames, and is gone again. Where a robot localises it may
/// have been carried away as well.
TEST(TraceSpan, ClosingLoopsItGoesOnThroughCuts) {
  TestArena memory;
  constexpr double novelty = 0.1;
  std::vector<BeliefTraces::Step> trace;
  for (std::size_t i = 0; i < 60; ++i) {
    const bool hidden = i >= 20 && i < 30;
    const bool cut = i == 19 || i == 29;
    trace.push_back({0, hidden ? -0.1 : 0.3, 0.1, cut ? 0.615 : 0.1});
  }
  for (const Use use : {Use::localise, Use::close_loops}) {
    SCOPED_TRACE(static_cast<int>(use));
    TraceSpan span(memory.arena, use, 60);
    const auto on = span.find(trace, 0.5, 0.0, novelty, 0.0, trace.size());
    EXPECT_EQ(on[25].still > 0.9, use == Use::close_loops) << on[25].still;
    EXPECT_EQ(on[10].still > 0.99, use == Use::close_loops) << on[10].still;
  }
}

/// What is usual is what the best of many rows gain. Where the trace leads on after it was left is
/// one row, so less speaks against having left it late.
TEST(TraceSpan, LastsWhereAFrameGainsLessThanIsUsualButMoreThanOneRowDoes) {
  TestArena memory;
  TraceSpan span(memory.arena, Use::localise, 60);
  constexpr double usual = 1.0;
  constexpr double novelty = 0.2;
  for (const double gain : {-0.15, 0.05}) {
    SCOPED_TRACE(gain);
    std::vector<BeliefTraces::Step> trace(20, {0, gain, 0.5, 0.5});
    trace.resize(50, {0, 1.0, 0.5, 0.5});
    span.ask(trace, usual);
    EXPECT_EQ(span.find(trace, 0.0, usual, novelty, 0.0, 50)[0].still > 0.5, gain > 0.0);
  }
}

/// Where a revisit begins the frames look as much alike as later on, so those that do less were
/// seen on the way there. Where it ends they do not.
TEST(TraceSpan, ClosingLoopsFirstFramesHaveToGainMoreThanHalfAsMuch) {
  TestArena memory;
  TraceSpan span(memory.arena, Use::close_loops, 60);
  constexpr double usual = 0.1;
  constexpr double novelty = 0.5;
  for (const double gain : {0.1, 0.9}) {
    SCOPED_TRACE(gain);
    std::vector<BeliefTraces::Step> begins(30, {0, 1.0, 0.5, 0.5});
    begins.resize(50, {0, gain, 0.5, 0.5});
    span.ask(begins, usual);
    EXPECT_EQ(span.find(begins, 0.0, usual, novelty, 0.0, 50)[45].still > 0.5, gain > 0.5);
    std::vector<BeliefTraces::Step> ends(20, {0, gain, 0.5, 0.5});
    ends.resize(50, {0, 1.0, 0.5, 0.5});
    span.ask(ends, usual);
    EXPECT_GT(span.find(ends, 0.0, usual, novelty, 0.0, 50)[5].still, 0.99);
  }
}

TEST(TraceSpan, NoTraceIsTooLong) {
  for (const Use use : {Use::localise, Use::close_loops}) {
    TestArena memory;
    TraceSpan span(memory.arena, use, 1001);
    // Of the older half of the frames, and of the newer one.
    for (const auto& [older, newer] :
         {std::pair{1.9, 1.9}, {-1.9, -1.9}, {0.0, 0.0}, {1.9, -1.9}, {-1.9, 1.9}, {-6.5, -6.5}}) {
      std::vector<BeliefTraces::Step> trace(1001, {0, older - 0.05, 0.5, 0.5});
      for (std::size_t i = 0; i < 500; ++i) trace[i].gain = newer - 0.05;
      for (const double before : {0.0, 0.5, 1.0}) {
        SCOPED_TRACE(std::to_string(before) + ", " + std::to_string(older) + ", " +
                     std::to_string(newer));
        for (const TraceSpan::On& on : span.find(trace, before, 0.1, 0.3, 0.0, trace.size())) {
          ASSERT_TRUE(on.still >= 0.0 && on.still <= 1.0) << on.still;
          ASSERT_TRUE(on.left >= 0.0 && on.left <= 1.0) << on.left;
        }
      }
    }
  }
}

TEST(TraceSpan, FramesThatWereMovedAlikeHaveAnAverageOfTheirOwn) {
  TestArena memory;
  const TraceSpan loops(memory.arena, Use::close_loops, 9);
  const TraceSpan localises(memory.arena, Use::localise, 9);
  // Three times three frames, which gain 4, 2 and .4 by novelty.
  std::vector<BeliefTraces::Step> trace;
  for (std::size_t i = 0; i < 9; ++i) {
    trace.push_back({i, i < 3 ? 2.0 : i < 6 ? 1.0 : 0.2, 0.5, 0.5});
  }
  const auto expect_asked = [&](const TraceSpan& span, double least, std::array<double, 3> asked) {
    span.ask(trace, least);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(trace[i].asked, asked[i / 3], 1e-12) << i;
  };
  constexpr double share = 0.7 * 0.5;
  constexpr double all = share * 6.4 / 3.0;
  expect_asked(loops, 0.1, {all, all, all});
  for (std::size_t i = 0; i < 9; ++i) trace[i].moved = i < 3 ? -2 : i < 6 ? -1 : -2;
  expect_asked(loops, 0.1, {share * 4.0, share * 2.0, share * 0.4});
  expect_asked(loops, 0.5, {share * 4.0, share * 2.0, 0.25});
  expect_asked(localises, 0.1, {0.05, 0.05, 0.05});
}

}  // namespace
}  // namespace seqloop
