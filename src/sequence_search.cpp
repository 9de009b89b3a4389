#include "seqloop/sequence_search.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace seqloop {
namespace {

// Rows summed side by side: the window's slices of this many rows stay in the second-level cache.
constexpr std::size_t block_rows = 256;

}  // namespace

SequenceSearch::SequenceSearch(Arena& arena, const Trajectories& trajectories, std::size_t places)
    : trajectories_(&trajectories),
      scores_(arena.take<float>("scores", places)),
      lines_(arena.take<std::uint32_t>("best lines", places)) {}

std::size_t SequenceSearch::score(const DifferenceSlices& slices, std::uint64_t oldest,
                                  CandidateRun run, std::size_t rows) noexcept {
  std::size_t line_sums = 0;
  for (std::size_t first = run.first; first < run.last; first += block_rows) {
    const CandidateRun block{first, std::min(first + block_rows, run.last)};
    std::fill(scores_.begin() + static_cast<std::ptrdiff_t>(block.first),
              scores_.begin() + static_cast<std::ptrdiff_t>(block.last),
              std::numeric_limits<float>::infinity());
    for (std::size_t line = 0; line < trajectories_->count(); ++line) {
      line_sums += score_line(slices, oldest, block, line, rows);
    }
  }
  return line_sums;
}

std::size_t SequenceSearch::score_line(const DifferenceSlices& slices, std::uint64_t oldest,
                                       CandidateRun block, std::size_t line,
                                       std::size_t rows) noexcept {
  const std::span<const std::int32_t> offsets = trajectories_->offsets(line);
  const auto below = static_cast<std::size_t>(-offsets.front());
  const auto above = static_cast<std::size_t>(offsets.back());
  if (rows <= above) return 0;
  const std::size_t first = std::max(block.first, below);
  const std::size_t last = std::min(block.last, rows - above);
  if (first >= last) return 0;
  const std::size_t count = last - first;

  std::array<float, block_rows> sums{};
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const float* differences =
        slices.column(oldest + i).data() + static_cast<std::ptrdiff_t>(first) + offsets[i];
    for (std::size_t j = 0; j < count; ++j) sums[j] += differences[j];
  }
  const auto window = static_cast<float>(offsets.size());
  for (std::size_t j = 0; j < count; ++j) {
    const float mean = sums[j] / window;
    if (mean < scores_[first + j]) {
      scores_[first + j] = mean;
      lines_[first + j] = static_cast<std::uint32_t>(line);
    }
  }
  return count;
}

}  // namespace seqloop
