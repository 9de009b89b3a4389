#include "seqloop/sequence_search.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

namespace seqloop {
namespace {

// Rows summed side by side: the window's slices of this many rows stay in the second-level cache.
constexpr std::size_t block_rows = 256;

}  // namespace

SequenceSearch::SequenceSearch(Arena& arena, const Trajectories& trajectories, std::size_t places)
    : trajectories_(&trajectories),
      scores_(arena.take<float>("scores", places)),
      lines_(arena.take<std::uint32_t>("best lines", places)),
      columns_(arena.take<const float*>("the window's columns", trajectories.window())) {}

std::size_t SequenceSearch::score(const DifferenceSlices& slices, std::uint64_t oldest,
                                  CandidateRun run, std::size_t rows) noexcept {
  for (std::size_t i = 0; i < columns_.size(); ++i) columns_[i] = slices.column(oldest + i).data();
  std::size_t line_sums = 0;
  for (std::size_t first = run.first; first < run.last; first += block_rows) {
    const CandidateRun block{first, std::min(first + block_rows, run.last)};
    std::fill(scores_.begin() + static_cast<std::ptrdiff_t>(block.first),
              scores_.begin() + static_cast<std::ptrdiff_t>(block.last),
              std::numeric_limits<float>::infinity());
    for (std::size_t line = 0; line < trajectories_->count(); ++line) {
      line_sums += score_line(block, line, rows);
    }
  }
  return line_sums;
}

std::size_t SequenceSearch::score_line(CandidateRun block, std::size_t line,
                                       std::size_t rows) noexcept {
  const std::span<const std::int32_t> offsets = trajectories_->offsets(line);
  const auto below = static_cast<std::size_t>(-offsets.front());
  const auto above = static_cast<std::size_t>(offsets.back());
  if (rows <= above) return 0;
  const std::size_t first = std::max(block.first, below);
  const std::size_t last = std::min(block.last, rows - above);
  if (first >= last) return 0;
  const std::size_t count = last - first;
  if (count >= 32) {
    score_tiles<32>({first, last}, line);
  } else if (count >= 8) {
    score_tiles<8>({first, last}, line);
  } else {
    score_tiles<1>({first, last}, line);
  }
  return count;
}

template <int Rows>
void SequenceSearch::score_tiles(CandidateRun run, std::size_t line) noexcept {
  // As many rows as registers hold are summed side by side; each row's sum runs along the window,
  // so that it does not depend on the tiling. The last tile overlaps the one before.
  using Tile = Eigen::Array<float, Rows, 1>;
  const std::span<const std::int32_t> offsets = trajectories_->offsets(line);
  const auto window = static_cast<float>(offsets.size());
  for (std::size_t row = run.first; row < run.last; row += Rows) {
    const std::size_t first = std::min(row, run.last - Rows);
    Tile sums = Tile::Zero();
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      sums += Eigen::Map<const Tile>(columns_[i] + static_cast<std::ptrdiff_t>(first) + offsets[i]);
    }
    for (int j = 0; j < Rows; ++j) {
      const float mean = sums[j] / window;
      const std::size_t scored = first + static_cast<std::size_t>(j);
      if (mean >= scores_[scored]) continue;
      scores_[scored] = mean;
      lines_[scored] = static_cast<std::uint32_t>(line);
    }
  }
}

}  // namespace seqloop
