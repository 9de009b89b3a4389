#pragma once

#include "kernels/blocks.hpp"

// Lanes: struct {
//   count: columns that are looked at at once; Sum: a register; Sum zero()
//   Sum add_difference(Sum, end, begin); add_values(before, values, after)
//   keep_lower(Sum, line, best, lines) }
namespace seqloop::kernels {

/// One column at a time: what is left where columns are fewer than lanes.
template <class Owner>
struct OneLane {
  static constexpr std::size_t count = 1;
  using Sum = std::uint32_t;
  static Sum zero() noexcept { return 0; }

  static Sum add_difference(Sum sum, const std::uint32_t* end,
                            const std::uint32_t* begin) noexcept {
    return sum + (*end - *begin);
  }

  static void add_values(const std::uint32_t* before, const std::uint16_t* values,
                         std::uint32_t* after) noexcept {
    *after = *before + *values;
  }

  static void keep_lower(Sum sum, std::uint32_t line, std::uint32_t* best,
                         std::uint32_t* lines) noexcept {
    if (sum >= *best) return;
    *best = sum;
    *lines = line;
  }
};

template <class Lanes>
void add_column(const std::uint32_t* before, const std::uint16_t* values, std::size_t count,
                std::uint32_t* after) noexcept {
  std::size_t i = 0;
  for (; i + Lanes::count <= count; i += Lanes::count) {
    Lanes::add_values(before + i, values + i, after + i);
  }
  for (; i < count; ++i) OneLane<Lanes>::add_values(before + i, values + i, after + i);
}

/// What one line is made from, and what is known of the best.
struct Line {
  const std::uint32_t* prefix;
  const LineSegment* segments;
  std::size_t segment_count;
  std::uint32_t line;
  std::uint32_t* best;
  std::uint32_t* lines;
};

/// @param first the first of `abreast` * lanes columns
template <class Lanes, std::size_t abreast>
void lowest_abreast(const Line& line, std::size_t first) noexcept {
  typename Lanes::Sum sums[abreast];
  for (auto& sum : sums) sum = Lanes::zero();
  for (std::size_t s = 0; s < line.segment_count; ++s) {
    const std::uint32_t* end = line.prefix + line.segments[s].end + first;
    const std::uint32_t* begin = line.prefix + line.segments[s].begin + first;
    for (std::size_t i = 0; i < abreast; ++i) {
      sums[i] = Lanes::add_difference(sums[i], end + i * Lanes::count, begin + i * Lanes::count);
    }
  }
  for (std::size_t i = 0; i < abreast; ++i) {
    const std::size_t column = first + i * Lanes::count;
    Lanes::keep_lower(sums[i], line.line, line.best + column, line.lines + column);
  }
}

/// All columns. The last ones may overlap those before, for which nothing changes any more.
/// @param count at least `abreast` * lanes
template <class Lanes, std::size_t abreast>
void lowest_of(const Line& line, std::size_t count) noexcept {
  constexpr std::size_t width = abreast * Lanes::count;
  for (std::size_t first = 0; first + width < count; first += width) {
    lowest_abreast<Lanes, abreast>(line, first);
  }
  lowest_abreast<Lanes, abreast>(line, count - width);
}

template <class Lanes>
void lowest_lines(const std::uint32_t* prefix, const LineSegment* segments,
                  std::size_t segment_count, std::size_t count, std::uint32_t number,
                  std::uint32_t* best, std::uint32_t* lines) noexcept {
  constexpr std::size_t abreast = 4;
  const Line line{prefix, segments, segment_count, number, best, lines};
  if (count >= abreast * Lanes::count) {
    lowest_of<Lanes, abreast>(line, count);
  } else if (count >= Lanes::count) {
    lowest_of<Lanes, 1>(line, count);
  } else if (count > 0) {
    lowest_of<OneLane<Lanes>, 1>(line, count);
  }
}

}  // namespace seqloop::kernels
