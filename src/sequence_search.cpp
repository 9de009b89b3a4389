#include "seqloop/sequence_search.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace seqloop {
namespace {

// Rows scored side by side: at usual sequence lengths their sums stay in the second-level cache.
constexpr std::size_t block_rows = 128;

/// How far lines leave the diagonals of velocity 1 through their centre rows, and in how many
/// pieces they run along them.
struct Shape {
  std::int64_t below = 0;
  std::int64_t above = 0;
  std::size_t segments = 0;
};

/// Diagonals that a line lies above its centre row's own, at column i of the window.
std::int64_t diagonal(std::int64_t m, std::size_t i, std::size_t ds) {
  const auto centre = static_cast<std::int64_t>(ds / 2);
  return trajectory_offset(m, i, ds) - (static_cast<std::int64_t>(i) - centre);
}

Shape shape_of(std::size_t ds, VelocityRange velocities) {
  Shape shape;
  for (std::int64_t m = velocities.first; m <= velocities.last; ++m) {
    for (std::size_t i = 0; i <= ds; ++i) {
      const std::int64_t here = diagonal(m, i, ds);
      shape.below = std::max(shape.below, -here);
      shape.above = std::max(shape.above, here);
      if (i == 0 || here != diagonal(m, i - 1, ds)) ++shape.segments;
    }
  }
  return shape;
}

}  // namespace

SequenceSearch::SequenceSearch(Arena& arena, const Trajectories& trajectories,
                               const MatcherConfig& config, std::size_t places)
    : trajectories_(&trajectories),
      kernels_(&best_integer_kernels()),
      scores_(arena.take<double>("scores", places)),
      lines_(arena.take<std::uint32_t>("best lines", places)) {
  const std::size_t ds = config.sequence_length;
  const VelocityRange velocities = velocity_range(ds, config.vmin, config.vmax);
  const Shape shape = shape_of(ds, velocities);
  below_ = static_cast<std::size_t>(shape.below);
  stride_ = block_rows + static_cast<std::size_t>(shape.below + shape.above);
  const bool whole = config.arithmetic != Arithmetic::float32;
  segments_ = arena.take<LineSegment>("pieces of lines", shape.segments);
  line_begins_ = arena.take<std::uint32_t>("first pieces of lines", velocities.count() + 1);
  const std::size_t sums = (ds + 2) * stride_;
  whole_sums_ = arena.take<std::uint32_t>("sums along diagonals", whole ? sums : 0);
  whole_lowest_ = arena.take<std::uint32_t>("lowest sums", whole ? block_rows : 0);
  sums_ = arena.take<double>("sums along diagonals", whole ? 0 : sums);
  lowest_ = arena.take<double>("lowest sums", whole ? 0 : block_rows);
  block_lines_ = arena.take<std::uint32_t>("lines of the lowest sums", block_rows);
  if (arena.measuring()) return;

  std::size_t count = 0;
  for (std::int64_t m = velocities.first; m <= velocities.last; ++m) {
    for (std::size_t i = 0; i <= ds; ++i) {
      const std::int64_t here = diagonal(m, i, ds);
      const auto column =
          static_cast<std::uint32_t>(static_cast<std::int64_t>(i * stride_) + shape.below + here);
      if (i == 0 || here != diagonal(m, i - 1, ds)) segments_[count++].begin = column;
      segments_[count - 1].end = column + static_cast<std::uint32_t>(stride_);
    }
    line_begins_[static_cast<std::size_t>(m - velocities.first) + 1] =
        static_cast<std::uint32_t>(count);
  }
}

std::size_t SequenceSearch::score(const DifferenceSlices& slices, const PlaceOrder& order,
                                  std::uint64_t oldest, CandidateRun run,
                                  std::size_t rows) noexcept {
  std::size_t line_sums = 0;
  for (std::size_t first = run.first; first < run.last; first += block_rows) {
    const CandidateRun block{first, std::min(first + block_rows, run.last)};
    line_sums += slices.whole()
                     ? score_block<std::uint16_t>(slices, order, oldest, block, rows, whole_sums_,
                                                  whole_lowest_)
                     : score_block<float>(slices, order, oldest, block, rows, sums_, lowest_);
  }
  return line_sums;
}

template <class Value, class Sum>
std::size_t SequenceSearch::score_block(const DifferenceSlices& slices, const PlaceOrder& order,
                                        std::uint64_t oldest, CandidateRun block, std::size_t rows,
                                        std::span<Sum> sums, std::span<Sum> lowest) noexcept {
  add_up<Value>(slices, order, oldest, block, rows, sums);
  std::ranges::fill(lowest, std::numeric_limits<Sum>::max());
  std::size_t line_sums = 0;
  for (std::size_t line = 0; line < trajectories_->count(); ++line) {
    const std::span<const std::int32_t> offsets = trajectories_->offsets(line);
    const auto below = static_cast<std::size_t>(-offsets.front());
    const auto above = static_cast<std::size_t>(offsets.back());
    if (rows <= above) continue;
    const std::size_t first = std::max(block.first, below);
    const std::size_t last = std::min(block.last, rows - above);
    if (first >= last) continue;
    lowest_of(sums, line, {first - block.first, last - block.first}, lowest);
    line_sums += last - first;
  }
  const double scale = 1.0 / (slices.unit() * static_cast<double>(trajectories_->window()));
  for (std::size_t row = block.first; row < block.last; ++row) {
    const Sum sum = lowest[row - block.first];
    scores_[row] = sum == std::numeric_limits<Sum>::max() ? std::numeric_limits<double>::infinity()
                                                          : static_cast<double>(sum) * scale;
    lines_[row] = block_lines_[row - block.first];
  }
  return line_sums;
}

/// Sums of differences along the diagonals through a block of rows and through those around it that
/// its lines can change to: before each column of the window, and behind the last. What was not
/// computed is added too, and taken off again with each piece of a line, which begins behind it.
template <class Value, class Sum>
void SequenceSearch::add_up(const DifferenceSlices& slices, const PlaceOrder& order,
                            std::uint64_t oldest, CandidateRun block, std::size_t rows,
                            std::span<Sum> sums) const noexcept {
  const std::size_t around = stride_ - block_rows;
  const auto diagonals = static_cast<std::int64_t>(block.last - block.first + around);
  std::ranges::fill(sums.first(static_cast<std::size_t>(diagonals)), Sum{0});
  for (std::size_t i = 0; i < trajectories_->window(); ++i) {
    const Value* const column = slices.column(oldest + i, Value{});
    const Sum* const before = &sums[i * stride_];
    Sum* const behind = &sums[(i + 1) * stride_];
    // The row at this column of the block's first diagonal; rows that are not there add nothing.
    const std::int64_t row = static_cast<std::int64_t>(block.first + i) -
                             static_cast<std::int64_t>(below_ + trajectories_->centre());
    const std::int64_t first = std::clamp<std::int64_t>(-row, 0, diagonals);
    const std::int64_t last =
        std::clamp<std::int64_t>(static_cast<std::int64_t>(rows) - row, first, diagonals);
    std::copy_n(before, first, behind);
    if (!order.straight()) {
      for (std::int64_t d = first; d < last; ++d) {
        const std::size_t slot = order.slot(static_cast<std::size_t>(row + d));
        behind[d] = before[d] + static_cast<Sum>(column[slot]);
      }
    } else if constexpr (std::is_same_v<Value, std::uint16_t>) {
      kernels_->add_column(before + first, column + row + first,
                           static_cast<std::size_t>(last - first), behind + first);
    } else {
      for (std::int64_t d = first; d < last; ++d) {
        behind[d] = before[d] + static_cast<Sum>(column[row + d]);
      }
    }
    std::copy(before + last, before + diagonals, behind + last);
  }
}

void SequenceSearch::lowest_of(std::span<const double> sums, std::size_t line, CandidateRun part,
                               std::span<double> lowest) noexcept {
  for (std::size_t row = part.first; row < part.last; ++row) {
    double sum = 0.0;
    for (const LineSegment& segment : segments(line)) {
      sum += sums[segment.end + row] - sums[segment.begin + row];
    }
    if (sum >= lowest[row]) continue;
    lowest[row] = sum;
    block_lines_[row] = static_cast<std::uint32_t>(line);
  }
}

void SequenceSearch::lowest_of(std::span<const std::uint32_t> sums, std::size_t line,
                               CandidateRun part, std::span<std::uint32_t> lowest) noexcept {
  const std::span<const LineSegment> pieces = segments(line);
  kernels_->lowest_lines(&sums[part.first], pieces.data(), pieces.size(), part.last - part.first,
                         static_cast<std::uint32_t>(line), &lowest[part.first],
                         &block_lines_[part.first]);
}

}  // namespace seqloop
