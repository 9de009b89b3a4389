// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/blocks.hpp"

// Differences: struct {
//   Sum: a register; Sum zero(); Sum add<words>(Sum, a, b): bits that differ in `words` words, a
//   block or half of one; totals(sums of sums_together, out); total(a sum) }
namespace seqloop::kernels {

/// The distances of one sketch to some that lie side by side.
/// @param bits [rows] written
template <class Differences, std::size_t rows>
[[gnu::always_inline]] inline void distances_abreast(const std::uint64_t* query,
                                                     const std::uint64_t* row, std::size_t words,
                                                     std::uint32_t* bits) noexcept {
  typename Differences::Sum sums[sums_together];
  for (auto& sum : sums) sum = Differences::zero();
  std::size_t first = 0;
  for (; first + words_per_block <= words; first += words_per_block) {
    for (std::size_t r = 0; r < rows; ++r) {
      sums[r] = Differences::template add<words_per_block>(sums[r], row + r * words + first,
                                                           query + first);
    }
  }
  if (first + words_per_half <= words) {
    for (std::size_t r = 0; r < rows; ++r) {
      sums[r] = Differences::template add<words_per_half>(sums[r], row + r * words + first,
                                                          query + first);
    }
    first += words_per_half;
  }
  if (first < words) {
    const LastBlock<Differences, std::uint64_t> last_query(query + first, words - first);
    for (std::size_t r = 0; r < rows; ++r) {
      const LastBlock<Differences, std::uint64_t> last_row(row + r * words + first, words - first);
      sums[r] =
          Differences::template add<words_per_half>(sums[r], last_row.values, last_query.values);
    }
  }
  if constexpr (rows == 1) {
    *bits = Differences::total(sums[0]);
  } else {
    std::uint32_t totals[sums_together];
    Differences::totals(sums, totals);
    for (std::size_t r = 0; r < rows; ++r) bits[r] = totals[r];
  }
}

// What most pairs of sketches are compared by, one pair at a time.
constexpr std::size_t words_looked_at = 2 * words_per_block;

template <class Differences>
std::uint32_t hamming(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) noexcept {
  std::uint32_t bits;
  // Known here, as in a column.
  if (words == words_looked_at) {
    distances_abreast<Differences, 1>(a, b, words_looked_at, &bits);
  } else {
    distances_abreast<Differences, 1>(a, b, words, &bits);
  }
  return bits;
}

// How far ahead of the row that is read another is fetched: the processor reads ahead by itself,
// but not beyond the page that it is in.
constexpr std::size_t words_ahead = 256;
constexpr std::size_t words_per_line = 8;

template <class Differences>
void column_of(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
               std::size_t count, std::uint32_t* bits) noexcept {
  std::size_t row = 0;
  for (; row + sums_together <= count; row += sums_together) {
    for (std::size_t word = row * words + words_ahead;
         word < (row + sums_together) * words + words_ahead && word < count * words;
         word += words_per_line) {
      __builtin_prefetch(rows + word);
    }
    distances_abreast<Differences, sums_together>(query, rows + row * words, words, bits + row);
  }
  for (; row < count; ++row) {
    distances_abreast<Differences, 1>(query, rows + row * words, words, bits + row);
  }
}

template <class Differences>
void hamming_column(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                    std::size_t count, std::uint32_t* bits) noexcept {
  // Known here, so that nothing is left to decide for each of so short rows.
  if (words == words_per_half) {
    column_of<Differences>(query, rows, words_per_half, count, bits);
  } else {
    column_of<Differences>(query, rows, words, count, bits);
  }
}

}  // namespace seqloop::kernels
