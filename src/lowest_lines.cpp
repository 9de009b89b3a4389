// SPDX-License-Identifier: MIT
#include "seqloop/detail/lowest_lines.hpp"

#include <algorithm>
#include <limits>

#include "seqloop/detail/keep_lowest.hpp"

namespace seqloop {
namespace {

constexpr std::size_t near = 6;  // rows on either side: their lines are much the same

}  // namespace

std::size_t lowest_lines(const SequenceSearch& search, const PlaceOrder& order,
                         std::span<const CandidateRun> runs, const BestRow& best,
                         std::span<FoundLine> lines) noexcept {
  std::size_t count = 0;
  const std::span<const double> scores = search.scores();
  for (const CandidateRun run : runs) {
    for (std::size_t row = run.first; row < run.last; ++row) {
      const double score = scores[row];
      if (score == std::numeric_limits<double>::infinity()) continue;
      if (count == lines.size() && score >= lines.back().score) continue;
      const CandidateRun session = order.around(row);
      const std::size_t first = std::max({run.first, session.first, row - std::min(row, near)});
      const std::size_t last = std::min({run.last, session.last, row + near + 1});
      bool lowest = true;
      for (std::size_t other = first; lowest && other < last; ++other) {
        lowest = scores[other] > score || (scores[other] == score && other >= row);
      }
      if (!lowest) continue;
      const double uniqueness = row == best.row ? best.uniqueness : score / best.score;
      count = keep_lowest(lines, count, FoundLine{row, score, uniqueness, search.line(row)},
                          &FoundLine::score);
    }
  }
  return count;
}

}  // namespace seqloop
