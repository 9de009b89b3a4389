// SPDX-License-Identifier: MIT
#pragma once

#include <hwy/highway.h>

#include <cstddef>

#include "kernels/blocks.hpp"
#include "kernels/float_squares.hpp"
#include "seqloop/detail/float_columns.hpp"

// Many vectors by many, where there are 16 registers: a register has the same lane of several rows,
// so that six queries by two registers of rows have room; their sums are added up lane by lane, as
// in lane_squares.hpp, without moving values across a register.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// Steps of a block: how many values of a lane are added up as floats.
inline constexpr std::size_t most_steps = float_block / lanes;

inline constexpr std::size_t tile_queries = 6;
inline constexpr std::size_t tile_vectors = 2;
inline constexpr std::size_t tile_rows = tile_vectors * squares_width;

/// Values from a lane of transposed rows to the next. Their lines begin at different places in the
/// nearest cache, which 16 lanes that are whole pages apart would push each other out of.
inline constexpr std::size_t rows_lane = most_steps * tile_rows + lanes;
inline constexpr std::size_t queries_lane = most_steps * tile_queries;
inline constexpr std::size_t tile_of_queries = lanes * queries_lane;

/// 4 values each of as many vectors as a register has fours.
template <class Tag>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<Tag> fours_of(Tag some, const float* from,
                                                 std::size_t stride) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  if constexpr (hn::MaxLanes(some) == 4) {
    return hn::LoadU(some, from);
  } else {
    const hn::Half<Tag> half;
    return hn::Combine(some, fours_of(half, from + hn::MaxLanes(half) * stride, stride),
                       fours_of(half, from, stride));
  }
}

/// 4 values of as many vectors as a register has lanes: the first of all, the second of all …
/// @param to the first; the others a lane further each
template <class Tag>
HWY_INLINE void transpose(Tag some, const float* from, std::size_t stride, float* to,
                          std::size_t lane) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::RepartitionToWide<Tag> pairs;
  const auto a = fours_of(some, from, stride);
  const auto b = fours_of(some, from + stride, stride);
  const auto c = fours_of(some, from + 2 * stride, stride);
  const auto d = fours_of(some, from + 3 * stride, stride);
  const auto low = hn::BitCast(pairs, hn::InterleaveLower(some, a, b));
  const auto high = hn::BitCast(pairs, hn::InterleaveUpper(some, a, b));
  const auto next_low = hn::BitCast(pairs, hn::InterleaveLower(some, c, d));
  const auto next_high = hn::BitCast(pairs, hn::InterleaveUpper(some, c, d));
  hn::StoreU(hn::BitCast(some, hn::InterleaveLower(pairs, low, next_low)), some, to);
  hn::StoreU(hn::BitCast(some, hn::InterleaveUpper(pairs, low, next_low)), some, to + lane);
  hn::StoreU(hn::BitCast(some, hn::InterleaveLower(pairs, high, next_high)), some, to + 2 * lane);
  hn::StoreU(hn::BitCast(some, hn::InterleaveUpper(pairs, high, next_high)), some, to + 3 * lane);
}

/// @param to [lanes][rows_lane]: [steps, tile_rows] of each lane
[[gnu::noinline]] void transpose_rows(const float* from, std::size_t stride, std::size_t steps,
                                      float* to) noexcept {
  const SquaresTag some;
  for (std::size_t vector = 0; vector < tile_rows; vector += squares_width) {
    for (std::size_t step = 0; step < steps; ++step) {
      for (std::size_t lane = 0; lane < lanes; lane += 4) {
        transpose(some, from + vector * stride + step * lanes + lane, stride,
                  to + lane * rows_lane + step * tile_rows + vector, rows_lane);
      }
    }
  }
}

/// @param queries 4 or 6   @param to [lanes][queries_lane]: [steps, tile_queries] of each lane
[[gnu::noinline]] void transpose_queries(const float* from, std::size_t queries, std::size_t stride,
                                         std::size_t steps, float* to) noexcept {
  const hwy::HWY_NAMESPACE::CappedTag<float, 4> some;
  for (std::size_t step = 0; step < steps; ++step) {
    for (std::size_t lane = 0; lane < lanes; lane += 4) {
      const float* at = from + step * lanes + lane;
      float* out = to + lane * queries_lane + step * tile_queries;
      // Of six the last four, and the first four, because registers hold four.
      if (queries == tile_queries) transpose(some, at + 2 * stride, stride, out + 2, queries_lane);
      transpose(some, at, stride, out, queries_lane);
    }
  }
}

template <std::size_t queries>
using TileSums = Squares[queries][tile_vectors];

/// The sums of one lane.
template <std::size_t queries>
HWY_INLINE void add_lane(const float* query, const float* rows, std::size_t steps,
                         TileSums<queries>& sums) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const SquaresTag some;
#pragma GCC unroll 16
  for (auto& of_query : sums) {
#pragma GCC unroll 16
    for (auto& sum : of_query) sum = hn::Zero(some);
  }
#pragma GCC unroll 4
  for (std::size_t step = 0; step < steps; ++step) {
    Squares row[tile_vectors];
#pragma GCC unroll 16
    for (std::size_t v = 0; v < tile_vectors; ++v) {
      row[v] = hn::LoadU(some, rows + v * squares_width);
    }
#pragma GCC unroll 16
    for (std::size_t q = 0; q < queries; ++q) {
      const auto value = hn::Set(some, query[q]);
#pragma GCC unroll 16
      for (std::size_t v = 0; v < tile_vectors; ++v) {
        const auto differ = hn::Sub(value, row[v]);
        sums[q][v] = hn::MulAdd(differ, differ, sums[q][v]);
      }
    }
    rows += tile_rows;
    query += tile_queries;
  }
}

/// Calls `work(q, v, offset)` for all sums of a tile, which are `offset` values behind the first.
template <std::size_t queries, class Work>
HWY_INLINE void for_sums(Work work) noexcept {
#pragma GCC unroll 16
  for (std::size_t q = 0; q < queries; ++q) {
#pragma GCC unroll 16
    for (std::size_t v = 0; v < tile_vectors; ++v) {
      work(q, v, (q * tile_vectors + v) * squares_width);
    }
  }
}

/// Adds what the next block of some queries and rows differs by.
/// @param query, rows transposed   @param totals the first query's of the first row
template <std::size_t queries>
[[gnu::noinline]] void add_tile(const float* query, const float* rows, std::size_t steps,
                                double* totals, std::size_t out_stride) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const SquaresTag some;
  const hn::Repartition<double, SquaresTag> wide;
  const hn::Rebind<float, decltype(wide)> narrow;
  alignas(stored_line) float even[queries * tile_rows];
  alignas(stored_line) float odd[queries * tile_rows];
  for (std::size_t four = 0; four < lanes; four += 4) {
    TileSums<queries> sums;
    const auto add = [&](std::size_t lane) {
      add_lane<queries>(query + lane * queries_lane, rows + lane * rows_lane, steps, sums);
    };
    // (0 + 2) + (1 + 3), and the sum to that of the fours before.
    add(four);
    for_sums<queries>([&](std::size_t q, std::size_t v, std::size_t at) {
      hn::StoreU(sums[q][v], some, even + at);
    });
    add(four + 2);
    for_sums<queries>([&](std::size_t q, std::size_t v, std::size_t at) {
      hn::StoreU(hn::Add(hn::LoadU(some, even + at), sums[q][v]), some, even + at);
    });
    add(four + 1);
    for_sums<queries>([&](std::size_t q, std::size_t v, std::size_t at) {
      hn::StoreU(sums[q][v], some, odd + at);
    });
    add(four + 3);
    for_sums<queries>([&](std::size_t q, std::size_t v, std::size_t at) {
      const auto sum =
          hn::Add(hn::LoadU(some, even + at), hn::Add(hn::LoadU(some, odd + at), sums[q][v]));
      double* total = totals + q * out_stride + v * squares_width;
      const auto move = [&](auto half, double* to) {
        hn::StoreU(hn::Add(hn::LoadU(wide, to), hn::PromoteTo(wide, half)), wide, to);
      };
      move(hn::LowerHalf(narrow, sum), total);
      move(hn::UpperHalf(narrow, sum), total + squares_width / 2);
    });
  }
}

void squares_block(const float* queries, std::size_t queries_count, const float* rows,
                   std::size_t stride, std::size_t count, double* sums, std::size_t out_stride,
                   float* room) noexcept {
  constexpr std::size_t last_queries = 4;
  constexpr std::size_t most_tiles = (FloatColumn::block_queries + tile_queries - 1) / tile_queries;
  static_assert(lanes * rows_lane + most_tiles * tile_of_queries <= FloatColumn::block_room);
  float* const near_queries = room + lanes * rows_lane;
  const std::size_t sixes = queries_count / tile_queries * tile_queries;
  const std::size_t whole_queries =
      sixes + (queries_count - sixes >= last_queries ? last_queries : 0);
  const std::size_t whole_rows = count / tile_rows * tile_rows;
  const auto for_tiles = [&](auto work) {
    for (std::size_t q = 0; q < whole_queries; q += q < sixes ? tile_queries : last_queries) {
      work(q, near_queries + q / tile_queries * tile_of_queries);
    }
  };
  for (std::size_t q = 0; q < whole_queries; ++q) {
    for (std::size_t r = 0; r < whole_rows; ++r) sums[q * out_stride + r] = 0.0;
  }
  for (std::size_t first = 0; whole_rows > 0 && first < stride; first += float_block) {
    const std::size_t length = stride - first < float_block ? stride - first : float_block;
    const std::size_t steps = length / lanes;
    for_tiles([&](std::size_t q, float* near) {
      transpose_queries(queries + q * stride + first, q < sixes ? tile_queries : last_queries,
                        stride, steps, near);
    });
    for (std::size_t r = 0; whole_queries > 0 && r < whole_rows; r += tile_rows) {
      transpose_rows(rows + r * stride + first, stride, steps, room);
      for_tiles([&](std::size_t q, const float* near) {
        const auto add = q < sixes ? &add_tile<tile_queries> : &add_tile<last_queries>;
        add(near, room, steps, sums + q * out_stride + r, out_stride);
      });
    }
  }
  squares_behind_tiles(queries, queries_count, whole_queries, rows, stride, count, whole_rows, sums,
                       out_stride);
}

}  // namespace
}  // namespace seqloop::kernels
