// SPDX-License-Identifier: MIT
// Runs of rows against a plain set of rows.
#include <random>
#include <set>

#include "core/matcher.hpp"
#include "seqloop/detail/candidate_runs.hpp"

namespace seqloop {
namespace {

using Rows = std::set<std::size_t>;

Rows rows_of(CandidateRun run) {
  Rows rows;
  for (std::size_t row = run.first; row < run.last; ++row) rows.insert(row);
  return rows;
}

TEST(CandidateRuns, EqualASetOfRows) {
  for (const std::size_t most_length : {1U, 3U, 12U, 70U}) {
    for (std::uint32_t seed = 1; seed <= 50; ++seed) {
      SCOPED_TRACE("length " + std::to_string(most_length) + ", seed " + std::to_string(seed));
      TestArena memory;
      constexpr std::size_t most = 30;
      CandidateRuns runs(memory.arena, most);
      std::mt19937 random(seed);
      for (int frame = 0; frame < 3; ++frame) {
        runs.clear();
        Rows set;
        for (std::size_t added = 0; added < most; ++added) {
          const std::size_t first = random() % 100;
          const CandidateRun run{first, first + random() % (most_length + 1)};  // some are empty
          Rows outside;
          std::size_t behind = 0;
          runs.for_each_outside(run, [&](CandidateRun part) {
            EXPECT_LT(part.first, part.last);
            EXPECT_GE(part.first, behind) << "in rising order";
            behind = part.last;
            outside.merge(rows_of(part));
          });
          Rows wanted;
          for (const std::size_t row : rows_of(run)) {
            if (!set.contains(row)) wanted.insert(row);
          }
          ASSERT_EQ(outside, wanted);

          runs.add(run);
          set.merge(rows_of(run));
          Rows united;
          std::size_t end = 0;
          for (const CandidateRun inside : runs.runs()) {
            ASSERT_LT(inside.first, inside.last);
            ASSERT_TRUE(united.empty() || inside.first > end) << "they do not touch";
            end = inside.last;
            united.merge(rows_of(inside));
          }
          ASSERT_EQ(united, set);
        }
      }
    }
  }
}

}  // namespace
}  // namespace seqloop
