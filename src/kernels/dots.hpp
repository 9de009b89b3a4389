// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/blocks.hpp"

// Products: struct {
//   step: values that are multiplied at once, a divisor of 64
//   Sum, Row, Query: registers; Sum zero(); Row row(from); Query query(from), a step each
//   Sum add(Sum, Row, Query)
//   totals(sums of sums_together, out), modulo 2^32
//   exceeds: whether sums are more than those of the products: by what a row of zeros gives
//   block_queries, block_rows: queries by rows, as many sums side by side as
//   there are registers; column_rows: the same, rows of one query }
namespace seqloop::kernels {

/// Bytes of queries that stay in the nearest cache while rows pass by.
inline constexpr std::size_t near_bytes = std::size_t{32} << 10U;

/// Bytes of rows that stay in the next cache while queries pass by.
inline constexpr std::size_t middle_bytes = std::size_t{256} << 10U;

/// Adds the products of one block; each step to another sum, so that none waits for the one before.
template <class Products>
void add_block(typename Products::Sum (&sums)[sums_together], const std::int8_t* row,
               const std::int8_t* query) noexcept {
  for (std::size_t i = 0; i < stored_line / Products::step; ++i) {
    auto& sum = sums[i % sums_together];
    sum = Products::add(sum, Products::row(row + i * Products::step),
                        Products::query(query + i * Products::step));
  }
}

/// Adds up products, with what is too much. Unsigned, because only the difference must fit 32 bits.
/// @param row_step from one block of the row to the next
template <class Products>
std::uint32_t total_of(const std::int8_t* row, std::size_t row_step, const std::int8_t* query,
                       std::size_t size) noexcept {
  typename Products::Sum sums[sums_together];
  for (auto& sum : sums) sum = Products::zero();
  std::size_t first = 0;
  for (; first + stored_line <= size; first += stored_line, row += row_step) {
    add_block<Products>(sums, row, query + first);
  }
  if (first < size) {
    const LastBlock<Products, std::int8_t> last_row(row, size - first);
    const LastBlock<Products, std::int8_t> last_query(query + first, size - first);
    add_block<Products>(sums, last_row.values, last_query.values);
  }
  std::uint32_t totals[sums_together];
  Products::totals(sums, totals);
  std::uint32_t total = 0;
  for (const std::uint32_t part : totals) total += part;
  return total;
}

/// What is too much in the sums of a query.
template <class Products>
std::uint32_t excess(const std::int8_t* query, std::size_t size) noexcept {
  if constexpr (Products::exceeds) {
    const LastBlock<Products, std::int8_t> zeros(query, 0);
    return total_of<Products>(zeros.values, 0, query, size);
  } else {
    return 0;
  }
}

template <class Products>
std::int32_t dot(const std::int8_t* a, const std::int8_t* b, std::size_t size) noexcept {
  return static_cast<std::int32_t>(total_of<Products>(a, stored_line, b, size) -
                                   excess<Products>(b, size));
}

/// What a block of dots is made from: vectors `stride` bytes apart, of which `length` count; and
/// where the dots go to, query by query.
struct DotTile {
  const std::int8_t* queries;
  const std::int8_t* rows;
  std::size_t stride;
  std::size_t length;
  std::int32_t* dots;
  std::size_t out_stride;

  /// The same further on. Templates, so that every file compiles its own.
  template <class Products>
  [[nodiscard]] DotTile skip(std::size_t queries_done, std::size_t rows_done) const noexcept {
    DotTile tile = *this;
    tile.queries += queries_done * stride;
    tile.rows += rows_done * stride;
    tile.dots += queries_done * out_stride + rows_done;
    return tile;
  }
};

/// Adds the products of some queries with some rows, all in registers: in loops that are unrolled
/// in a function of its own, or GCC would keep some in memory.
/// @param tile of at least one step
template <class Products, std::size_t queries, std::size_t rows>
[[gnu::noinline]] void add_dots(const DotTile& tile) noexcept {
  constexpr std::size_t count = (queries * rows + sums_together - 1) / sums_together;
  typename Products::Sum sums[count][sums_together];
#pragma GCC unroll 16
  for (auto& four : sums) {
#pragma GCC unroll 16
    for (auto& sum : four) sum = Products::zero();
  }
  std::size_t first = 0;
  do {
    typename Products::Row row[rows];
#pragma GCC unroll 16
    for (std::size_t r = 0; r < rows; ++r) {
      row[r] = Products::row(tile.rows + r * tile.stride + first);
    }
#pragma GCC unroll 16
    for (std::size_t q = 0; q < queries; ++q) {
      const auto query = Products::query(tile.queries + q * tile.stride + first);
#pragma GCC unroll 16
      for (std::size_t r = 0; r < rows; ++r) {
        auto& sum = sums[(q * rows + r) / sums_together][(q * rows + r) % sums_together];
        sum = Products::add(sum, row[r], query);
      }
    }
    first += Products::step;
  } while (first < tile.length);
  std::uint32_t totals[count][sums_together];
#pragma GCC unroll 16
  for (std::size_t four = 0; four < count; ++four) Products::totals(sums[four], totals[four]);
#pragma GCC unroll 16
  for (std::size_t q = 0; q < queries; ++q) {
#pragma GCC unroll 16
    for (std::size_t r = 0; r < rows; ++r) {
      const std::size_t sum = q * rows + r;
      std::int32_t& dot = tile.dots[q * tile.out_stride + r];
      dot = static_cast<std::int32_t>(static_cast<std::uint32_t>(dot) +
                                      totals[sum / sums_together][sum % sums_together]);
    }
  }
}

/// The same for any number of rows: `column_rows` side by side, then half as many, and so on.
template <class Products, std::size_t queries, std::size_t rows>
void add_rows(const DotTile& tile, std::size_t count) noexcept {
  std::size_t row = 0;
  for (; row + rows <= count; row += rows) {
    add_dots<Products, queries, rows>(tile.template skip<Products>(0, row));
  }
  if constexpr (rows > 1) {
    add_rows<Products, queries, rows / 2>(tile.template skip<Products>(0, row), count - row);
  }
}

/// The same for any number of queries. Where they are long, a part of them at a time, that stays
/// near while all rows pass by.
template <class Products, std::size_t queries>
void add_queries(const DotTile& tile, std::size_t count, std::size_t rows) noexcept {
  constexpr std::size_t rows_abreast = queries == 1 ? Products::column_rows : Products::block_rows;
  const std::size_t parts = (tile.length * queries + near_bytes - 1) / near_bytes;
  const std::size_t lines = tile.length / stored_line;
  std::size_t query = 0;
  for (; query + queries <= count; query += queries) {
    for (std::size_t part = 0; part < parts; ++part) {
      DotTile near = tile.template skip<Products>(query, 0);
      const std::size_t first = lines * part / parts * stored_line;
      near.queries += first;
      near.rows += first;
      near.length = lines * (part + 1) / parts * stored_line - first;
      add_rows<Products, queries, rows_abreast>(near, rows);
    }
  }
  if constexpr (queries > 1) {
    add_queries<Products, queries / 2>(tile.template skip<Products>(query, 0), count - query, rows);
  }
}

template <class Products>
void dot_block(const std::int8_t* queries, std::size_t queries_count, const std::int8_t* rows,
               std::size_t stride, std::size_t count, std::int32_t* dots,
               std::size_t out_stride) noexcept {
  for (std::size_t query = 0; query < queries_count; ++query) {
    const std::uint32_t too_much = excess<Products>(queries + query * stride, stride);
    for (std::size_t row = 0; row < count; ++row) {
      dots[query * out_stride + row] = static_cast<std::int32_t>(0U - too_much);
    }
  }
  if (stride == 0) return;
  const DotTile all{queries, rows, stride, stride, dots, out_stride};
  const std::size_t fit = middle_bytes / stride / Products::block_rows * Products::block_rows;
  const std::size_t some = fit == 0 ? Products::block_rows : fit;
  for (std::size_t row = 0; row < count; row += some) {
    add_queries<Products, Products::block_queries>(all.template skip<Products>(0, row),
                                                   queries_count,
                                                   count - row < some ? count - row : some);
  }
}

template <class Products>
void dot_column(const std::int8_t* query, const std::int8_t* rows, std::size_t stride,
                std::size_t count, std::int32_t* dots) noexcept {
  dot_block<Products>(query, 1, rows, stride, count, dots, count);
}

}  // namespace seqloop::kernels
