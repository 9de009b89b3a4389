// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace seqloop {

/// How one kind of processor compares a descriptor of floats with many. What is added to what, and
/// in which order, is that of `dot` in all variants: their sums are the same to the last bit.
struct FloatColumn {
  std::string_view name;  ///< such as "avx2"

  /// Whether the processor that runs this has the instructions. Work: a few instructions.
  bool (*supported)() noexcept;

  /// Dot products of one vector and consecutive rows.
  /// @param query  [stride]   @param rows [count, stride]   @param stride a whole number of lanes
  /// @param out    [count] written
  /// Work: count * stride fused multiply-adds; reads the rows once, front to back.
  void (*dots)(const float* query, const float* rows, std::size_t stride, std::size_t count,
               double* out) noexcept;

  /// The same of several vectors, several times faster than one by one: what is read of a row is
  /// used for some of them.
  /// @param queries       [queries_count, stride]
  /// @param out           [queries_count, out_stride] written: out[q * out_stride + r] is of query
  ///                      q and row r; nothing behind the first `count` of each
  /// @param out_stride    at least count
  /// Work: queries_count times that of `dots`. Reads the rows once as long as the queries, 2 KB of
  /// each at a time, fit the second cache. Takes 20 KB of stack.
  void (*dots_block)(const float* queries, std::size_t queries_count, const float* rows,
                     std::size_t stride, std::size_t count, double* out,
                     std::size_t out_stride) noexcept;
};

/// All variants that this library was built with, the best first, the one in plain C++ last. Not
/// all need be supported here.
[[nodiscard]] std::span<const FloatColumn* const> float_columns() noexcept;

/// The first supported one. Ask once and keep the answer.
[[nodiscard]] const FloatColumn& best_float_column() noexcept;

}  // namespace seqloop
