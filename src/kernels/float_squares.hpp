// SPDX-License-Identifier: MIT
#pragma once

#include <hwy/highway.h>

#include <cstddef>

#include "seqloop/difference.hpp"

// Highway's headers turn this into the instructions that the file which includes it is compiled
// for. What is added to what is as in difference.cpp.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// @param sums [rows] written
template <std::size_t rows>
void squares_abreast(const float* query, const float* row, std::size_t stride,
                     double* sums) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<float, lanes> some;
  constexpr std::size_t width = hn::MaxLanes(some);
  constexpr std::size_t parts = lanes / width;
  for (std::size_t r = 0; r < rows; ++r) sums[r] = 0.0;
  for (std::size_t first = 0; first < stride; first += float_block) {
    const std::size_t last = first + float_block < stride ? first + float_block : stride;
    hn::Vec<decltype(some)> partial[rows][parts];
    for (auto& of_row : partial) {
      for (auto& part : of_row) part = hn::Zero(some);
    }
    for (std::size_t i = first; i < last; i += lanes) {
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t at = i + part * width;
        const auto here = hn::LoadU(some, query + at);
        for (std::size_t r = 0; r < rows; ++r) {
          const auto differ = hn::Sub(here, hn::LoadU(some, row + r * stride + at));
          partial[r][part] = hn::Add(partial[r][part], hn::Mul(differ, differ));
        }
      }
    }
    for (std::size_t r = 0; r < rows; ++r) {
      float values[lanes];
      for (std::size_t part = 0; part < parts; ++part) {
        hn::StoreU(partial[r][part], some, values + part * width);
      }
      for (const float value : values) sums[r] += static_cast<double>(value);
    }
  }
}

void squares(const float* query, const float* rows, std::size_t stride, std::size_t count,
             double* sums) noexcept {
  // Memory brings several long rows at a time sooner than one after the other, and short ones in
  // the order in which they lie there.
  constexpr std::size_t abreast = 8;
  constexpr std::size_t long_row = 2048;
  std::size_t row = 0;
  for (; stride >= long_row && row + abreast <= count; row += abreast) {
    squares_abreast<abreast>(query, rows + row * stride, stride, sums + row);
  }
  for (; row < count; ++row) squares_abreast<1>(query, rows + row * stride, stride, sums + row);
}

// Rows whose sums of lanes are added up together.
constexpr std::size_t tile_rows = 4;

/// Some queries by some rows, a register of sums each; vectors `stride` values apart.
struct SquaresTile {
  const float* queries;
  const float* rows;
  std::size_t stride;
  double* sums;
  std::size_t out_stride;
};

/// Adds what a part of the vectors differs by, at most `float_block` long.
/// @param length a whole number of lanes
template <std::size_t queries>
[[gnu::noinline]] void add_squares(const SquaresTile& tile, std::size_t length) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<float, lanes> some;
  const hn::FixedTag<float, tile_rows> four;
  const hn::FixedTag<double, tile_rows> wide;
  constexpr std::size_t width = hn::MaxLanes(some);
  for (std::size_t part = 0; part < lanes; part += width) {
    hn::Vec<decltype(some)> partial[queries][tile_rows];
#pragma GCC unroll 16
    for (auto& of_query : partial) {
#pragma GCC unroll 16
      for (auto& of_pair : of_query) of_pair = hn::Zero(some);
    }
    for (std::size_t i = part; i < length; i += lanes) {
      hn::Vec<decltype(some)> row[tile_rows];
#pragma GCC unroll 16
      for (std::size_t r = 0; r < tile_rows; ++r) {
        row[r] = hn::LoadU(some, tile.rows + r * tile.stride + i);
      }
#pragma GCC unroll 16
      for (std::size_t q = 0; q < queries; ++q) {
        const auto query = hn::LoadU(some, tile.queries + q * tile.stride + i);
#pragma GCC unroll 16
        for (std::size_t r = 0; r < tile_rows; ++r) {
          const auto differ = hn::Sub(query, row[r]);
          partial[q][r] = hn::Add(partial[q][r], hn::Mul(differ, differ));
        }
      }
    }
#pragma GCC unroll 16
    for (std::size_t q = 0; q < queries; ++q) {
      float values[width * tile_rows];
      hn::StoreInterleaved4(partial[q][0], partial[q][1], partial[q][2], partial[q][3], some,
                            values);
      double* const to = tile.sums + q * tile.out_stride;
      auto sums = hn::LoadU(wide, to);
      for (std::size_t lane = 0; lane < width; ++lane) {
        sums = hn::Add(sums, hn::PromoteTo(wide, hn::LoadU(four, values + lane * tile_rows)));
      }
      hn::StoreU(sums, wide, to);
    }
  }
}

void squares_block(const float* queries, std::size_t queries_count, const float* rows,
                   std::size_t stride, std::size_t count, double* sums,
                   std::size_t out_stride) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  // As many sums as there are registers, besides the rows, a query and what they differ by.
  constexpr std::size_t abreast = hn::MaxLanes(hn::CappedTag<float, lanes>()) == lanes ? 4 : 2;
  const std::size_t whole_queries = queries_count / abreast * abreast;
  const std::size_t whole_rows = count / tile_rows * tile_rows;
  for (std::size_t q = 0; q < whole_queries; ++q) {
    for (std::size_t r = 0; r < whole_rows; ++r) sums[q * out_stride + r] = 0.0;
  }
  for (std::size_t first = 0; first < stride; first += float_block) {
    const std::size_t length = stride - first < float_block ? stride - first : float_block;
    // Some rows stay in the nearest cache while the queries pass by.
    for (std::size_t r = 0; r < whole_rows; r += tile_rows) {
      for (std::size_t q = 0; q < whole_queries; q += abreast) {
        add_squares<abreast>({queries + q * stride + first, rows + r * stride + first, stride,
                              sums + q * out_stride + r, out_stride},
                             length);
      }
    }
  }
  for (std::size_t q = 0; q < queries_count; ++q) {
    const std::size_t done = q < whole_queries ? whole_rows : 0;
    squares(queries + q * stride, rows + done * stride, stride, count - done,
            sums + q * out_stride + done);
  }
}

}  // namespace
}  // namespace seqloop::kernels
