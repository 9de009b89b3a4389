// SPDX-License-Identifier: MIT
// Candidate ranges beside Algorithm 4.
#include "seqloop/detail/candidate_ranges.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

TEST(CandidateRanges, ClipUniteAndRankAsAlgorithmFourSays) {
  TestArena memory;
  MatcherConfig config;
  config.candidates = Candidates::ranges;
  config.relocalising.on = false;
  config.k = 3;
  config.num = 4;
  CandidateRanges ranges(memory.arena, config);
  CandidateRuns united(memory.arena, 3);
  PlaceOrder order(memory.arena, 20, 1);
  for (std::uint64_t frame = 0; frame < 20; ++frame) static_cast<void>(order.append(frame));
  const auto runs = [&](std::size_t rows) {
    united.clear();
    for (const CandidateRun range : ranges.choose(order, rows)) united.add(range);
    std::vector<std::pair<std::size_t, std::size_t>> all;
    for (const CandidateRun run : united.runs()) all.emplace_back(run.first, run.last);
    return all;
  };
  using Runs = std::vector<std::pair<std::size_t, std::size_t>>;
  constexpr double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(runs(20), (Runs{{0, 20}})) << "the first frame searches all";
  std::vector<double> scores(20, none);
  scores[0] = 0.3;
  scores[19] = 0.2;
  scores[10] = 0.1;
  scores[5] = 0.3;  // as good as row 0, but higher
  ranges.update(scores, united.runs(), 10, 1.0);
  EXPECT_EQ(runs(20), (Runs{{0, 3}, {8, 13}, {17, 20}})) << "clipped at both ends";
  std::ranges::fill(scores, none);
  scores[10] = 0.1;
  scores[12] = 0.2;
  ranges.update(scores, united.runs(), 10, 1.0);
  EXPECT_EQ(runs(20), (Runs{{8, 15}})) << "fewer rows than K, and they overlap";
  ranges.removed(11);
  EXPECT_EQ(runs(20), (Runs{{8, 14}})) << "the row behind the one that went is counted one lower";
  ranges.removed(0);
  EXPECT_EQ(runs(20), (Runs{{7, 13}}));
  ranges.skip(order, 4);
  EXPECT_EQ(runs(20), (Runs{{11, 17}}));
  ranges.update(scores, united.runs(), std::nullopt, 1.0);
  EXPECT_EQ(runs(20), (Runs{{0, 20}})) << "after a frame without an answer";
  EXPECT_EQ(runs(0), Runs{}) << "an empty map";
}

}  // namespace
}  // namespace seqloop
