#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "seqloop/integer_kernels.hpp"

// The loops of all variants, over blocks of 64 bytes. A variant brings two types from its own
// unnamed namespace, so that what is compiled here for its processor stays in its file:
//
// Products: struct { Sum: a few registers;
//   Sum zero(); Sum add(Sum, row, query): one block; uint32 total(Sum), modulo 2^32;
//   store_totals(sums of rows_abreast rows, too much, out);
//   uint32 row_offset: what `add` takes every value of the row to be larger by }
// Differences: struct { Sum; zero(); add(Sum, a, b): bits that differ in one block; uint32 total }
namespace seqloop::kernels {

/// Rows that a column sums side by side, so that one sum's latency hides behind the others'.
inline constexpr std::size_t rows_abreast = 4;

inline constexpr std::size_t words_per_block = row_bytes / sizeof(std::uint64_t);

/// Less than a block, with zeros behind it.
template <class Owner>
struct LastBlock {
  LastBlock(const void* from, std::size_t size) noexcept { std::memcpy(bytes, from, size); }
  alignas(row_bytes) unsigned char bytes[row_bytes] = {};
};

/// What is too much in a sum of products. Unsigned, because only the difference must fit 32 bits.
template <class Products>
std::uint32_t excess(const std::int8_t* query, std::size_t size) noexcept {
  if constexpr (Products::row_offset == 0) return 0;
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < size; ++i) sum += static_cast<std::uint32_t>(query[i]);
  return sum * Products::row_offset;
}

template <class Products>
std::int32_t dot(const std::int8_t* a, const std::int8_t* b, std::size_t size) noexcept {
  auto sum = Products::zero();
  std::size_t first = 0;
  for (; first + row_bytes <= size; first += row_bytes) {
    sum = Products::add(sum, a + first, b + first);
  }
  if (first < size) {
    const LastBlock<Products> last_a(a + first, size - first);
    const LastBlock<Products> last_b(b + first, size - first);
    sum = Products::add(sum, reinterpret_cast<const std::int8_t*>(last_a.bytes),
                        reinterpret_cast<const std::int8_t*>(last_b.bytes));
  }
  return static_cast<std::int32_t>(Products::total(sum) - excess<Products>(b, size));
}

/// The dots with as many rows as are summed side by side.
template <class Products>
void dots_abreast(const std::int8_t* query, const std::int8_t* rows, std::size_t stride,
                  std::uint32_t too_much, std::int32_t* out) noexcept {
  typename Products::Sum sums[rows_abreast];
  for (auto& sum : sums) sum = Products::zero();
  for (std::size_t first = 0; first < stride; first += row_bytes) {
    for (std::size_t row = 0; row < rows_abreast; ++row) {
      sums[row] = Products::add(sums[row], rows + row * stride + first, query + first);
    }
  }
  Products::store_totals(sums, too_much, out);
}

template <class Products>
void dot_column(const std::int8_t* query, const std::int8_t* rows, std::size_t stride,
                std::size_t count, std::int32_t* out) noexcept {
  const std::uint32_t too_much = excess<Products>(query, stride);
  std::size_t row = 0;
  for (; row + rows_abreast <= count; row += rows_abreast) {
    dots_abreast<Products>(query, rows + row * stride, stride, too_much, out + row);
  }
  for (; row < count; ++row) {
    out[row] = dot<Products>(rows + row * stride, query, stride);
  }
}

template <class Differences>
std::uint32_t hamming(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) noexcept {
  auto sum = Differences::zero();
  std::size_t first = 0;
  for (; first + words_per_block <= words; first += words_per_block) {
    sum = Differences::add(sum, a + first, b + first);
  }
  if (first < words) {
    const std::size_t bytes = (words - first) * sizeof(std::uint64_t);
    const LastBlock<Differences> last_a(a + first, bytes);
    const LastBlock<Differences> last_b(b + first, bytes);
    sum = Differences::add(sum, reinterpret_cast<const std::uint64_t*>(last_a.bytes),
                           reinterpret_cast<const std::uint64_t*>(last_b.bytes));
  }
  return Differences::total(sum);
}

template <class Differences>
void hamming_column(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                    std::size_t count, std::uint32_t* out) noexcept {
  for (std::size_t row = 0; row < count; ++row) {
    out[row] = hamming<Differences>(query, rows + row * words, words);
  }
}

template <class Products, class Differences>
constexpr IntegerKernels made_of(std::string_view name, bool (*supported)() noexcept) noexcept {
  return {name,
          supported,
          &dot<Products>,
          &dot_column<Products>,
          &hamming<Differences>,
          &hamming_column<Differences>};
}

}  // namespace seqloop::kernels
