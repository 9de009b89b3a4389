// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "seqloop/detail/line_through_sums.hpp"

namespace seqloop {

/// Sums over floats, made for one kind of processor. What is added to what, and in which order, is
/// the same in all variants, for dot products that of `dot`: so are their sums, to the last bit.
/// Memory may lie anywhere; nothing outside what is named is read. Alike in all: no allocation.
struct FloatKernels {
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

  /// Sums up diagonals: sums[j] is the sum of values[i][j] over all i; and before each i but the
  /// first, sums[i * stride + j] is what j has more so far than j + 1. From the first i to the
  /// last.
  /// @param values [window] pointers to [count + 1]   @param window above 0
  /// @param sums   [window, stride] the first `count` of each written
  /// Work: 3 window * count adds.
  void (*sum_diagonals)(const float* const* values, std::size_t window, std::size_t count,
                        std::size_t stride, double* sums) noexcept;

  /// Keeps, for consecutive columns, the line with the lowest sum. Column j's sum is that of
  /// sums[end + j] and the sum of all sums[change + j]. Of equal sums, the earlier line's stays.
  /// @param sums    read at [offset, offset + count) for the ends and changes of the lines
  /// @param changes of all lines
  /// @param lines   [line_count]   @param number of the first of them
  /// @param best    [count] lowest sums so far, read and written
  /// @param best_lines [count] the numbers of their lines, below 2^31, read and written
  /// Work: count adds for each end and each change.
  void (*lowest_lines)(const double* sums, const std::uint32_t* changes,
                       const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                       std::size_t count, double* best, std::uint32_t* best_lines) noexcept;
};

/// All variants that this library was built with, the best first, the one in plain C++ last. Not
/// all need be supported here.
[[nodiscard]] std::span<const FloatKernels* const> float_kernels() noexcept;

/// The first supported one. Ask once and keep the answer.
[[nodiscard]] const FloatKernels& best_float_kernels() noexcept;

}  // namespace seqloop
