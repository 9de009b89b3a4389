// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "kernels/blocks.hpp"
#include "seqloop/detail/line_through_sums.hpp"

// Lanes: struct {
//   Value, Number: what is summed up, and to what: uint16 to uint32, modulo 2^32, or float to
//   double count: columns that are looked at at once; Sum: a register of numbers Sum load(from);
//   store(Sum, to); Sum widen(values) Sum number(line): in every lane; Sum load_lines(from);
//   store_lines(Sum, to) Sum add(Sum, Sum); Sum take_off(Sum, Sum) keep_lower(Sum, line, Sum& best,
//   Sum& best_lines) }
namespace seqloop::kernels {

/// One column at a time: what is left where columns are fewer than lanes.
/// @tparam Owner of the file that compiles it
template <class Owner, class Value_, class Number_>
struct OneLane {
  using Value = Value_;
  using Number = Number_;
  static constexpr std::size_t count = 1;
  using Sum = Number;
  static Sum load(const Number* from) noexcept { return *from; }
  static void store(Sum sum, Number* to) noexcept { *to = sum; }
  static Sum widen(const Value* values) noexcept { return static_cast<Number>(*values); }
  static Sum number(std::uint32_t line) noexcept { return static_cast<Number>(line); }
  static Sum load_lines(const std::uint32_t* from) noexcept { return number(*from); }
  static void store_lines(Sum line, std::uint32_t* to) noexcept {
    *to = static_cast<std::uint32_t>(line);
  }
  static Sum add(Sum a, Sum b) noexcept { return a + b; }
  static Sum take_off(Sum a, Sum b) noexcept { return a - b; }

  static void keep_lower(Sum sum, Sum line, Sum& best, Sum& best_line) noexcept {
    if (sum >= best) return;
    best = sum;
    best_line = line;
  }
};

/// For what is left of some lanes.
template <class Lanes>
using Rest = OneLane<Lanes, typename Lanes::Value, typename Lanes::Number>;

/// What diagonals are summed up from and to.
template <class Lanes>
struct Diagonals {
  const typename Lanes::Value* const* values;
  std::size_t window;
  std::size_t stride;
  typename Lanes::Number* sums;
};

/// @param first the first of `abreast` * lanes diagonals
template <class Lanes, std::size_t abreast, class All>
void sum_abreast(const All& all, std::size_t first) noexcept {
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
void sum_diagonals(const typename Lanes::Value* const* values, std::size_t window,
                   std::size_t count, std::size_t stride, typename Lanes::Number* sums) noexcept {
  constexpr std::size_t abreast = 2;
  const Diagonals<Lanes> all{values, window, stride, sums};
  std::size_t first = 0;
  for (; first + abreast * Lanes::count <= count; first += abreast * Lanes::count) {
    sum_abreast<Lanes, abreast>(all, first);
  }
  for (; first + Lanes::count <= count; first += Lanes::count) sum_abreast<Lanes, 1>(all, first);
  for (; first < count; ++first) sum_abreast<Rest<Lanes>, 1>(all, first);
}

/// What lines are made from, and what is known of the best.
template <class Lanes>
struct Lines {
  const typename Lanes::Number* sums;
  const std::uint32_t* changes;
  const LineThroughSums* lines;
  std::size_t line_count;
  std::uint32_t number;
  typename Lanes::Number* best;
  std::uint32_t* best_lines;
};

/// @param column the first of `abreast` * lanes columns
template <class Lanes, std::size_t abreast, class All>
void lowest_abreast(const All& all, std::size_t column) noexcept {
  typename Lanes::Sum best[abreast];
  typename Lanes::Sum best_lines[abreast];
  for (std::size_t i = 0; i < abreast; ++i) {
    best[i] = Lanes::load(all.best + column + i * Lanes::count);
    best_lines[i] = Lanes::load_lines(all.best_lines + column + i * Lanes::count);
  }
  const auto* const sums = all.sums + column;
  for (std::size_t l = 0; l < all.line_count; ++l) {
    const LineThroughSums line = all.lines[l];
    typename Lanes::Sum apart[abreast];
    for (auto& sum : apart) sum = Lanes::number(0);
    for (std::size_t c = line.first_change; c < line.last_change; ++c) {
      const auto* const change = sums + all.changes[c];
      for (std::size_t i = 0; i < abreast; ++i) {
        apart[i] = Lanes::add(apart[i], Lanes::load(change + i * Lanes::count));
      }
    }
    const auto number = Lanes::number(all.number + static_cast<std::uint32_t>(l));
    for (std::size_t i = 0; i < abreast; ++i) {
      const auto whole = Lanes::load(sums + line.end + i * Lanes::count);
      const auto sum = line.rises ? Lanes::add(whole, apart[i]) : Lanes::take_off(whole, apart[i]);
      Lanes::keep_lower(sum, number, best[i], best_lines[i]);
    }
  }
  for (std::size_t i = 0; i < abreast; ++i) {
    Lanes::store(best[i], all.best + column + i * Lanes::count);
    Lanes::store_lines(best_lines[i], all.best_lines + column + i * Lanes::count);
  }
}

/// All columns. The last ones may overlap those before, for which nothing changes any more.
/// @param count at least `abreast` * lanes
template <class Lanes, std::size_t abreast, class All>
void lowest_of(const All& all, std::size_t count) noexcept {
  constexpr std::size_t width = abreast * Lanes::count;
  for (std::size_t first = 0; first + width < count; first += width) {
    lowest_abreast<Lanes, abreast>(all, first);
  }
  lowest_abreast<Lanes, abreast>(all, count - width);
}

template <class Lanes>
void lowest_lines(const typename Lanes::Number* sums, const std::uint32_t* changes,
                  const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                  std::size_t count, typename Lanes::Number* best,
                  std::uint32_t* best_lines) noexcept {
  constexpr std::size_t abreast = 4;
  const Lines<Lanes> all{sums, changes, lines, line_count, number, best, best_lines};
  if (count >= abreast * Lanes::count) {
    lowest_of<Lanes, abreast>(all, count);
  } else if (count >= Lanes::count) {
    lowest_of<Lanes, 1>(all, count);
  } else if (count > 0) {
    lowest_of<Rest<Lanes>, 1>(all, count);
  }
}

}  // namespace seqloop::kernels
