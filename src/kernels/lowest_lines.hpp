// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/blocks.hpp"

// Lanes: struct {
//   count: columns that are looked at at once; Sum: a register; Sum load(from); store(Sum, to)
//   Sum number(line): in every lane
//   Sum add(Sum, Sum); Sum take_off(Sum, Sum)
//   keep_lower(Sum, line, Sum& best, Sum& best_lines)
//   Sum widen(values) }
namespace seqloop::kernels {

/// One column at a time: what is left where columns are fewer than lanes.
template <class Owner>
struct OneLane {
  static constexpr std::size_t count = 1;
  using Sum = std::uint32_t;
  static Sum load(const std::uint32_t* from) noexcept { return *from; }
  static void store(Sum sum, std::uint32_t* to) noexcept { *to = sum; }
  static Sum number(std::uint32_t line) noexcept { return line; }
  static Sum widen(const std::uint16_t* values) noexcept { return *values; }
  static Sum add(Sum a, Sum b) noexcept { return a + b; }
  static Sum take_off(Sum a, Sum b) noexcept { return a - b; }

  static void keep_lower(Sum sum, Sum line, Sum& best, Sum& best_line) noexcept {
    if (sum >= best) return;
    best = sum;
    best_line = line;
  }
};

/// What diagonals are summed up from and to.
struct Diagonals {
  const std::uint16_t* const* values;
  std::size_t window;
  std::size_t stride;
  std::uint32_t* sums;
};

/// @param first the first of `abreast` * lanes diagonals
template <class Lanes, std::size_t abreast>
void sum_abreast(const Diagonals& all, std::size_t first) noexcept {
  typename Lanes::Sum sums[abreast];
  typename Lanes::Sum apart[abreast];
  for (std::size_t v = 0; v < abreast; ++v) {
    sums[v] = Lanes::number(0);
    apart[v] = sums[v];
  }
  for (std::size_t i = 0; i < all.window; ++i) {
    for (std::size_t v = 0; v < abreast; ++v) {
      const std::size_t at = first + v * Lanes::count;
      // Where whole sums will be: nothing is apart before the first column.
      Lanes::store(apart[v], all.sums + i * all.stride + at);
      const auto here = Lanes::widen(all.values[i] + at);
      const auto next = Lanes::widen(all.values[i] + at + 1);
      sums[v] = Lanes::add(sums[v], here);
      apart[v] = Lanes::add(apart[v], Lanes::take_off(here, next));
    }
  }
  for (std::size_t v = 0; v < abreast; ++v) {
    Lanes::store(sums[v], all.sums + first + v * Lanes::count);
  }
}

template <class Lanes>
void sum_diagonals(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                   std::size_t stride, std::uint32_t* sums) noexcept {
  constexpr std::size_t abreast = 2;
  const Diagonals all{values, window, stride, sums};
  std::size_t first = 0;
  for (; first + abreast * Lanes::count <= count; first += abreast * Lanes::count) {
    sum_abreast<Lanes, abreast>(all, first);
  }
  for (; first + Lanes::count <= count; first += Lanes::count) sum_abreast<Lanes, 1>(all, first);
  for (; first < count; ++first) sum_abreast<OneLane<Lanes>, 1>(all, first);
}

/// What lines are made from, and what is known of the best.
struct Lines {
  const std::uint32_t* sums;
  const std::uint32_t* changes;
  const LineThroughSums* lines;
  std::size_t line_count;
  std::uint32_t number;
  std::uint32_t* best;
  std::uint32_t* best_lines;
};

template <class Lanes, std::size_t abreast, auto change>
void change_diagonals(const Lines& all, const LineThroughSums& line, const std::uint32_t* sums,
                      typename Lanes::Sum (&line_sums)[abreast]) noexcept {
  for (std::size_t c = line.first_change; c < line.last_change; ++c) {
    const std::uint32_t* const apart = sums + all.changes[c];
    for (std::size_t i = 0; i < abreast; ++i) {
      line_sums[i] = change(line_sums[i], Lanes::load(apart + i * Lanes::count));
    }
  }
}

/// @param column the first of `abreast` * lanes columns
template <class Lanes, std::size_t abreast>
void lowest_abreast(const Lines& all, std::size_t column) noexcept {
  typename Lanes::Sum best[abreast];
  typename Lanes::Sum best_lines[abreast];
  for (std::size_t i = 0; i < abreast; ++i) {
    best[i] = Lanes::load(all.best + column + i * Lanes::count);
    best_lines[i] = Lanes::load(all.best_lines + column + i * Lanes::count);
  }
  for (std::size_t l = 0; l < all.line_count; ++l) {
    const LineThroughSums line = all.lines[l];
    const std::uint32_t* const sums = all.sums + column;
    typename Lanes::Sum line_sums[abreast];
    for (std::size_t i = 0; i < abreast; ++i) {
      line_sums[i] = Lanes::load(sums + line.end + i * Lanes::count);
    }
    if (line.rises) {
      change_diagonals<Lanes, abreast, Lanes::add>(all, line, sums, line_sums);
    } else {
      change_diagonals<Lanes, abreast, Lanes::take_off>(all, line, sums, line_sums);
    }
    const auto number = Lanes::number(all.number + static_cast<std::uint32_t>(l));
    for (std::size_t i = 0; i < abreast; ++i) {
      Lanes::keep_lower(line_sums[i], number, best[i], best_lines[i]);
    }
  }
  for (std::size_t i = 0; i < abreast; ++i) {
    Lanes::store(best[i], all.best + column + i * Lanes::count);
    Lanes::store(best_lines[i], all.best_lines + column + i * Lanes::count);
  }
}

/// All columns. The last ones may overlap those before, for which nothing changes any more.
/// @param count at least `abreast` * lanes
template <class Lanes, std::size_t abreast>
void lowest_of(const Lines& all, std::size_t count) noexcept {
  constexpr std::size_t width = abreast * Lanes::count;
  for (std::size_t first = 0; first + width < count; first += width) {
    lowest_abreast<Lanes, abreast>(all, first);
  }
  lowest_abreast<Lanes, abreast>(all, count - width);
}

template <class Lanes>
void lowest_lines(const std::uint32_t* sums, const std::uint32_t* changes,
                  const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                  std::size_t count, std::uint32_t* best, std::uint32_t* best_lines) noexcept {
  constexpr std::size_t abreast = 4;
  const Lines all{sums, changes, lines, line_count, number, best, best_lines};
  if (count >= abreast * Lanes::count) {
    lowest_of<Lanes, abreast>(all, count);
  } else if (count >= Lanes::count) {
    lowest_of<Lanes, 1>(all, count);
  } else if (count > 0) {
    lowest_of<OneLane<Lanes>, 1>(all, count);
  }
}

}  // namespace seqloop::kernels
