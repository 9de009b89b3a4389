// SPDX-License-Identifier: MIT
#pragma once

#include <hwy/highway.h>

#include <cstddef>

#include "seqloop/difference.hpp"

// Highway's headers turn this into the instructions that the file which includes it is compiled
// for. What is added to what is as in lane_squares.hpp.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// As many of the lanes of a sum as a register holds.
using SquaresTag = hwy::HWY_NAMESPACE::CappedTag<float, lanes>;
using Squares = hwy::HWY_NAMESPACE::Vec<SquaresTag>;
inline constexpr std::size_t squares_width = hwy::HWY_NAMESPACE::MaxLanes(SquaresTag());

/// Rows whose sums of lanes are added up together.
inline constexpr std::size_t rows_together = 4;

/// Adds up four lanes each of the sums of four rows, and these in double to what was there.
/// @param totals [4]
HWY_INLINE void add_lanes(const Squares* sums, double* totals) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const SquaresTag some;
  const hn::RepartitionToWide<SquaresTag> pairs;
  const auto both = [&](Squares a, Squares b) {
    return hn::BitCast(pairs, hn::Add(hn::InterleaveLower(a, b), hn::InterleaveUpper(some, a, b)));
  };
  const auto first = both(sums[0], sums[1]);
  const auto last = both(sums[2], sums[3]);
  float fours[squares_width];
  hn::StoreU(hn::Add(hn::BitCast(some, hn::InterleaveLower(first, last)),
                     hn::BitCast(some, hn::InterleaveUpper(pairs, first, last))),
             some, fours);
  const hn::CappedTag<double, rows_together> wide;
  const hn::Rebind<float, decltype(wide)> narrow;
  for (std::size_t row = 0; row < rows_together; row += hn::MaxLanes(wide)) {
    auto total = hn::LoadU(wide, totals + row);
    for (std::size_t four = row; four < squares_width; four += rows_together) {
      total = hn::Add(total, hn::PromoteTo(wide, hn::LoadU(narrow, fours + four)));
    }
    hn::StoreU(total, wide, totals + row);
  }
}

/// Some queries by some rows, a register of sums each; vectors a stride of values apart.
struct SquaresTile {
  const float* queries;
  std::size_t query_stride;
  const float* rows;
  std::size_t row_stride;
  double* sums;
  std::size_t out_stride;
};

/// Adds what a part of the vectors differs by, at most `float_block` long. Loops are unrolled in a
/// function of its own, or GCC would keep some of the sums in memory.
/// @param length a whole number of lanes   @param fetch `fetch(i)` has memory ready that comes next
template <std::size_t queries, std::size_t rows, class Fetch>
[[gnu::noinline]] void add_squares(const SquaresTile& tile, std::size_t length,
                                   Fetch fetch) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const SquaresTag some;
  for (std::size_t part = 0; part < lanes; part += squares_width) {
    Squares sums[queries][rows];
#pragma GCC unroll 16
    for (auto& of_query : sums) {
#pragma GCC unroll 16
      for (auto& sum : of_query) sum = hn::Zero(some);
    }
    for (std::size_t i = part; i < length; i += lanes) {
      fetch(i);
      Squares row[rows];
#pragma GCC unroll 16
      for (std::size_t r = 0; r < rows; ++r) {
        row[r] = hn::LoadU(some, tile.rows + r * tile.row_stride + i);
      }
#pragma GCC unroll 16
      for (std::size_t q = 0; q < queries; ++q) {
        const auto query = hn::LoadU(some, tile.queries + q * tile.query_stride + i);
#pragma GCC unroll 16
        for (std::size_t r = 0; r < rows; ++r) {
          const auto differ = hn::Sub(query, row[r]);
          sums[q][r] = hn::MulAdd(differ, differ, sums[q][r]);
        }
      }
    }
#pragma GCC unroll 16
    for (std::size_t q = 0; q < queries; ++q) {
#pragma GCC unroll 16
      for (std::size_t r = 0; r < rows; r += rows_together) {
        add_lanes(&sums[q][r], tile.sums + q * tile.out_stride + r);
      }
    }
  }
}

/// One query by some rows of any length.
/// @param row_stride 0 for a row that counts several times
template <std::size_t rows>
void squares_abreast(const float* query, const float* row, std::size_t row_stride,
                     std::size_t length, double* sums) noexcept {
  for (std::size_t r = 0; r < rows; ++r) sums[r] = 0.0;
  for (std::size_t first = 0; first < length; first += float_block) {
    const std::size_t part = length - first < float_block ? length - first : float_block;
    add_squares<1, rows>({query + first, 0, row + first, row_stride, sums, 0}, part,
                         [](std::size_t) {});
  }
}

void squares(const float* query, const float* rows, std::size_t stride, std::size_t count,
             double* sums) noexcept {
  // Memory brings several long rows at a time sooner than few.
  constexpr std::size_t abreast = 2 * rows_together;
  constexpr std::size_t long_row = 2048;
  std::size_t row = 0;
  for (; stride >= long_row && row + abreast <= count; row += abreast) {
    squares_abreast<abreast>(query, rows + row * stride, stride, stride, sums + row);
  }
  for (; row + rows_together <= count; row += rows_together) {
    squares_abreast<rows_together>(query, rows + row * stride, stride, stride, sums + row);
  }
  for (; row < count; ++row) {
    double same[rows_together];
    squares_abreast<rows_together>(query, rows + row * stride, 0, stride, same);
    sums[row] = same[0];
  }
}

/// Of several queries by several rows what whole tiles leave: the rows behind them, and all rows of
/// the queries behind them.
/// @param whole_queries, whole_rows in tiles
void squares_behind_tiles(const float* queries, std::size_t queries_count,
                          std::size_t whole_queries, const float* rows, std::size_t stride,
                          std::size_t count, std::size_t whole_rows, double* sums,
                          std::size_t out_stride) noexcept {
  for (std::size_t q = 0; q < queries_count; ++q) {
    const std::size_t done = q < whole_queries ? whole_rows : 0;
    squares(queries + q * stride, rows + done * stride, stride, count - done,
            sums + q * out_stride + done);
  }
}

}  // namespace
}  // namespace seqloop::kernels
