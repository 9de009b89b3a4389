// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "seqloop/difference.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// How one kind of processor compares a descriptor of floats with many. What is added to what, and
/// in which order, is that of `euclidean` in all variants: their sums are the same to the last bit.
struct FloatColumn {
  std::string_view name;  ///< such as "avx2"

  /// Whether the processor that runs this has the instructions. Work: a few instructions.
  bool (*supported)() noexcept;

  /// Sums of squared differences of one vector and consecutive rows.
  /// @param query  [stride]   @param rows [count, stride]   @param stride a whole number of lanes
  /// @param sums   [count] written
  /// Work: count * stride subtractions and fused multiply-adds; reads the rows once, front to back.
  void (*squares)(const float* query, const float* rows, std::size_t stride, std::size_t count,
                  double* sums) noexcept;

  /// The same of several vectors, several times faster than one by one: what is read of a row is
  /// used for some of them.
  /// @param queries       [queries_count, stride]   @param queries_count at most `block_queries`
  /// @param sums          [queries_count, out_stride] written: sums[q * out_stride + r] is of query
  ///                      q and row r; nothing behind the first `count` of each
  /// @param out_stride    at least count
  /// @param room          [block_room] written
  /// Work: queries_count times that of `squares`. Reads the rows once as long as `count` of them
  /// and the queries, 4 KB of each at a time, fit the second cache. Takes 16 KB of stack.
  void (*squares_block)(const float* queries, std::size_t queries_count, const float* rows,
                        std::size_t stride, std::size_t count, double* sums, std::size_t out_stride,
                        float* room) noexcept;

  /// Queries that `squares_block` takes.
  static constexpr std::size_t block_queries = MatcherConfig::most_frames_at_once;

  /// Values that it has room for: the next 1,024 of all queries, in sixes, and of 16 rows, whose
  /// lanes would share places in the nearest cache without the rest.
  static constexpr std::size_t block_room =
      (block_queries + 5) / 6 * 6 * float_block + lanes * (float_block + lanes);
};

/// All variants that this library was built with, the best first, the one in plain C++ last. Not
/// all need be supported here.
[[nodiscard]] std::span<const FloatColumn* const> float_columns() noexcept;

/// The first supported one. Ask once and keep the answer.
[[nodiscard]] const FloatColumn& best_float_column() noexcept;

}  // namespace seqloop
