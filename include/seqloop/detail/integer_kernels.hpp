// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "seqloop/detail/line_through_sums.hpp"

namespace seqloop {

/// Bytes that a stored row of small values is a whole number of: a cache line. The rest is zero.
inline constexpr std::size_t stored_line = 64;

/// Bytes that one stored row takes: D rounded up to whole cache lines.
[[nodiscard]] constexpr std::size_t padded_bytes(std::size_t descriptor_size) noexcept {
  return (descriptor_size + stored_line - 1) / stored_line * stored_line;
}

/// Values of a vector up to which no dot product of values -127 .. 127 leaves 32 bits:
/// 127 * 127 * 2^17 < 2^31.
inline constexpr std::size_t most_small_values = std::size_t{1} << 17U;

/// Sums over int8 vectors, over bits and along lines, made for one kind of processor. Integers have
/// no rounding: every variant gives the same numbers to the last bit. Memory may lie anywhere;
/// nothing outside what is named is read. Alike in all: no allocation.
///
/// Plain pointers, because a variant's file is compiled for its processor: an inline function of
/// the C++ library compiled there could be linked in for all.
struct IntegerKernels {
  std::string_view name;  ///< such as "avx2": for people, and to ask for one

  /// Whether the processor that runs this has the instructions. Work: a few instructions.
  bool (*supported)() noexcept;

  /// @param a, b [size] -127 .. 127   @param size up to most_small_values
  /// @return sum of a[i] * b[i]. Work: size MACs.
  std::int32_t (*dot)(const std::int8_t* a, const std::int8_t* b, std::size_t size) noexcept;

  /// The dots of one vector with consecutive rows.
  /// @param query  [stride] -127 .. 127, zero beyond D
  /// @param rows   [count, stride] the same
  /// @param stride bytes from row to row, a whole number of stored_line, up to most_small_values
  /// @param dots   [count] written
  /// Work: count * stride MACs; reads the rows once, front to back.
  void (*dot_column)(const std::int8_t* query, const std::int8_t* rows, std::size_t stride,
                     std::size_t count, std::int32_t* dots) noexcept;

  /// The same of several vectors, many times faster than one by one: what is read of a row is used
  /// for up to eight of them. 16 to 64 queries at once are fastest where the rows lie outside the
  /// second cache, for which some of them stay there while all queries pass by.
  /// @param queries       [queries_count, stride] as above
  /// @param queries_count any
  /// @param dots          [queries_count, out_stride] written: dots[q * out_stride + r] is of query
  ///                      q and row r; nothing behind the first `count` of each
  /// @param out_stride    at least count
  /// Work: queries_count * count * stride MACs; reads the rows once, some at a time.
  void (*dot_block)(const std::int8_t* queries, std::size_t queries_count, const std::int8_t* rows,
                    std::size_t stride, std::size_t count, std::int32_t* dots,
                    std::size_t out_stride) noexcept;

  /// @param a, b [words]
  /// @return bits that differ. Work: words.
  std::uint32_t (*hamming)(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept;

  /// The Hamming distances of one sketch to consecutive ones.
  /// @param query [words]   @param rows [count, words]   @param bits [count] written
  /// Work: count * words; reads the rows once, front to back.
  void (*hamming_column)(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept;

  /// Sums up diagonals, modulo 2^32: sums[j] is the sum of values[i][j] over all i; and before each
  /// i but the first, sums[i * stride + j] is what j has more so far than j + 1.
  /// @param values [window] pointers to [count + 1]   @param window above 0
  /// @param sums   [window, stride] the first `count` of each written
  /// Work: 3 window * count adds.
  void (*sum_diagonals)(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                        std::size_t stride, std::uint32_t* sums) noexcept;

  /// Keeps, for consecutive columns, the line with the lowest sum. Column j's sum is that of
  /// sums[end + j] and all sums[change + j], modulo 2^32: right where the true sum fits 32 bits,
  /// even if what was added up does not. Of equal sums, the earlier line's stays.
  /// @param sums    read at [offset, offset + count) for the ends and changes of the lines
  /// @param changes of all lines
  /// @param lines   [line_count]   @param number of the first of them
  /// @param best    [count] lowest sums so far, read and written
  /// @param best_lines [count] the numbers of their lines, read and written
  /// Work: count adds for each end and each change.
  void (*lowest_lines)(const std::uint32_t* sums, const std::uint32_t* changes,
                       const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                       std::size_t count, std::uint32_t* best, std::uint32_t* best_lines) noexcept;

  /// The sketches of `sketched_together` descriptors, the same to the bit as one by one.
  /// @param both   what `side_by_side` wrote
  /// @param chosen [sketched_values(words)] for this D
  /// @param out    [words] each, written
  /// Work: as `sketch` for each; side by side.
  void (*sketch_together)(const std::uint8_t* both, const std::uint32_t* chosen, std::size_t words,
                          std::uint64_t* const* out) noexcept;
};

/// All variants that this library was built with, the best first, the one in plain C++ last. Not
/// all need be supported here.
[[nodiscard]] std::span<const IntegerKernels* const> integer_kernels() noexcept;

/// The first supported one. Ask once and keep the answer.
[[nodiscard]] const IntegerKernels& best_integer_kernels() noexcept;

}  // namespace seqloop
