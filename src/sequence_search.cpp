// SPDX-License-Identifier: MIT
#include "seqloop/detail/sequence_search.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace seqloop {
namespace {

// Rows scored side by side: at usual sequence lengths their sums stay in the second-level cache.
constexpr std::size_t block_rows = 128;

// Sums are continued in whole vectors of this many, the widest that any processor has.
constexpr std::size_t vector_lanes = 16;

std::size_t whole_vectors(std::size_t count) {
  return (count + vector_lanes - 1) / vector_lanes * vector_lanes;
}

/// How far lines leave the diagonals of velocity 1 through their centre rows, and how often they
/// change from one to the next.
struct Shape {
  std::int64_t below = 0;
  std::int64_t above = 0;
  std::int64_t changes = 0;
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
      if (i > 0) shape.changes += std::abs(here - diagonal(m, i - 1, ds));
    }
  }
  return shape;
}

}  // namespace

SequenceSearch::SequenceSearch(Arena& arena, const Trajectories& trajectories,
                               const MatcherConfig& config, std::size_t places)
    : trajectories_(&trajectories),
      kernels_(&best_integer_kernels()),
      float_kernels_(&best_float_kernels()),
      scores_(arena.take<double>("scores", places)),
      lines_(arena.take<std::uint32_t>("best lines", places)) {
  const std::size_t ds = config.sequence_length;
  const VelocityRange velocities = velocity_range(ds, config.vmin, config.vmax);
  const Shape shape = shape_of(ds, velocities);
  below_ = static_cast<std::size_t>(shape.below);
  around_ = static_cast<std::size_t>(shape.below + shape.above);
  stride_ = whole_vectors(block_rows + around_);
  const bool whole = config.arithmetic != Arithmetic::float32;
  through_ = arena.take<LineThroughSums>("lines through sums", velocities.count());
  changes_ =
      arena.take<std::uint32_t>("changes of diagonal", static_cast<std::size_t>(shape.changes));
  const std::uint64_t sums = std::uint64_t{ds + 1} * stride_;
  const bool gathered = config.full_map != FullMap::refuse;
  if (whole) {
    whole_sums_ = arena.take<std::uint32_t>("sums along diagonals", sums);
    whole_lowest_ = arena.take<std::uint32_t>("lowest sums", block_rows);
    whole_columns_.take(arena, ds + 1, stride_, gathered);
  } else {
    sums_ = arena.take<double>("sums along diagonals", sums);
    lowest_ = arena.take<double>("lowest sums", block_rows);
    columns_.take(arena, ds + 1, stride_, gathered);
  }
  block_lines_ = arena.take<std::uint32_t>("lines of the lowest sums", block_rows);
  if (arena.measuring()) return;

  std::uint32_t count = 0;
  for (std::size_t line = 0; line < through_.size(); ++line) {
    const std::int64_t m = velocities.first + static_cast<std::int64_t>(line);
    LineThroughSums& through = through_[line];
    through.first_change = count;
    through.rises = m > static_cast<std::int64_t>(ds);
    std::int64_t here = diagonal(m, 0, ds);
    for (std::size_t i = 1; i <= ds; ++i) {
      for (const std::int64_t next = diagonal(m, i, ds); here != next;) {
        here += through.rises ? 1 : -1;
        const std::int64_t lower = through.rises ? here - 1 : here;
        changes_[count++] =
            static_cast<std::uint32_t>(i * stride_ + static_cast<std::size_t>(shape.below + lower));
      }
    }
    through.last_change = count;
    through.end = static_cast<std::uint32_t>(shape.below + here);
  }
}

template <class Value>
void SequenceSearch::Columns<Value>::take(Arena& arena, std::size_t window, std::size_t stride,
                                          bool gathered) {
  begins = arena.take<const Value*>("columns of the window", window);
  values = arena.take<const Value*>("columns of the window", window);
  in_order = arena.take<Value>("differences in order", gathered ? window * (stride + 1) : 0);
}

std::size_t SequenceSearch::score(const DifferenceSlices& slices, const PlaceOrder& order,
                                  std::uint64_t oldest, CandidateRun run,
                                  std::size_t rows) noexcept {
  const double scale = 1.0 / (slices.unit() * static_cast<double>(trajectories_->window()));
  std::size_t line_sums = 0;
  order.in_sessions(run, [&](CandidateRun part) {
    CandidateRun session = order.around(part.first);
    session.last = std::min(session.last, rows);
    line_sums += slices.whole() ? score_run(slices, order, oldest, part, session, scale,
                                            whole_columns_, whole_sums_, whole_lowest_)
                                : score_run(slices, order, oldest, part, session, scale, columns_,
                                            sums_, lowest_);
  });
  return line_sums;
}

template <class Value, class Sum>
std::size_t SequenceSearch::score_run(const DifferenceSlices& slices, const PlaceOrder& order,
                                      std::uint64_t oldest, CandidateRun run, CandidateRun session,
                                      double scale, Columns<Value>& columns, std::span<Sum> sums,
                                      std::span<Sum> lowest) noexcept {
  for (std::size_t i = 0; i < trajectories_->window(); ++i) {
    columns.begins[i] = slices.column(oldest + i, Value{});
  }
  std::size_t line_sums = 0;
  for (std::size_t first = run.first; first < run.last; first += block_rows) {
    const CandidateRun block{first, std::min(first + block_rows, run.last)};
    add_up(order, block, columns, sums);
    line_sums += score_block<Sum>(block, session, scale, sums, lowest);
  }
  return line_sums;
}

template <class Sum>
std::size_t SequenceSearch::score_block(CandidateRun block, CandidateRun session, double scale,
                                        std::span<const Sum> sums, std::span<Sum> lowest) noexcept {
  std::ranges::fill(lowest, std::numeric_limits<Sum>::max());
  const std::size_t size = block.last - block.first;
  const std::size_t count = trajectories_->count();
  const auto furthest_below = static_cast<std::size_t>(-trajectories_->lowest(0));
  const auto furthest_above =
      static_cast<std::size_t>(trajectories_->highest(trajectories_->window() - 1));
  std::size_t line_sums = 0;
  if (block.first >= session.first + furthest_below &&
      block.last + furthest_above <= session.last) {
    keep_lowest(sums, {0, count}, {0, whole_vectors(size)}, lowest);
    line_sums = count * size;
  } else {
    for (std::size_t line = 0; line < count; ++line) {
      const std::span<const std::int32_t> offsets = trajectories_->offsets(line);
      const auto below = static_cast<std::size_t>(-offsets.front());
      const auto above = static_cast<std::size_t>(offsets.back());
      if (session.last <= above) continue;
      const std::size_t first = std::max(block.first, session.first + below);
      const std::size_t last = std::min(block.last, session.last - above);
      if (first >= last) continue;
      keep_lowest(sums, {line, line + 1}, {first - block.first, last - block.first}, lowest);
      line_sums += last - first;
    }
  }
  for (std::size_t row = block.first; row < block.last; ++row) {
    const Sum sum = lowest[row - block.first];
    scores_[row] = sum == std::numeric_limits<Sum>::max() ? std::numeric_limits<double>::infinity()
                                                          : static_cast<double>(sum) * scale;
    lines_[row] = block_lines_[row - block.first];
  }
  return line_sums;
}

/// Sums up the diagonals through a block of rows and those around it that its lines can change to:
/// first whole ones; then, before each column but the first, what each has more than the next.
/// Differences that were not computed, or lie beyond the map's ends, are added too and taken off
/// again by each line, which does not touch them.
template <class Value, class Sum>
void SequenceSearch::add_up(const PlaceOrder& order, CandidateRun block, Columns<Value>& columns,
                            std::span<Sum> sums) noexcept {
  const std::size_t diagonals = whole_vectors(block.last - block.first + around_);
  for (std::size_t i = 0; i < trajectories_->window(); ++i) {
    // The row at this column of the block's first diagonal.
    const std::int64_t row = static_cast<std::int64_t>(block.first + i) -
                             static_cast<std::int64_t>(below_ + trajectories_->centre());
    if (order.straight()) {
      columns.values[i] = columns.begins[i] + row;
      continue;
    }
    Value* const in_order = &columns.in_order[i * (stride_ + 1)];
    const auto rows = static_cast<std::int64_t>(order.size());
    for (std::size_t d = 0; d <= diagonals; ++d) {
      const std::int64_t r = row + static_cast<std::int64_t>(d);
      const bool there = r >= 0 && r < rows;
      in_order[d] = there ? columns.begins[i][order.slot(static_cast<std::size_t>(r))] : Value{0};
    }
    columns.values[i] = in_order;
  }
  kernels(Sum{}).sum_diagonals(columns.values.data(), columns.values.size(), diagonals, stride_,
                               sums.data());
}

template <class Sum>
void SequenceSearch::keep_lowest(std::span<const Sum> sums, LineRun lines, CandidateRun part,
                                 std::span<Sum> lowest) noexcept {
  kernels(Sum{}).lowest_lines(&sums[part.first], changes_.data(), &through_[lines.first],
                              lines.last - lines.first, static_cast<std::uint32_t>(lines.first),
                              part.last - part.first, &lowest[part.first],
                              &block_lines_[part.first]);
}

}  // namespace seqloop
