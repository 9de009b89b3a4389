// SPDX-License-Identifier: MIT
#include <immintrin.h>

#include "kernels/composed_of.hpp"
#include "kernels/float_dots.hpp"
#include "kernels/four_sums.hpp"
#include "kernels/highway.hpp"
#include "kernels/sketches.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

/// vpmaddubsw multiplies unsigned values by signed ones and adds up pairs, which fit 16 bits as
/// long as no value is -128: a query's sizes by the row's values, all bits of which are turned over
/// where the query's is negative: the negative less 1, which any execution unit computes.
struct Products {
  // Not __m256i: GCC 12 would copy every sum from type to type in the loop, and keep one in memory.
  struct Sum {
    __v8si lanes;
  };
  struct Row {
    __m256i values;
  };
  struct Query {
    __m256i sizes;
    __m256i signs;
  };
  static constexpr std::size_t step = 32;
  static constexpr bool exceeds = true;
  static constexpr std::size_t block_queries = 2;
  static constexpr std::size_t block_rows = 4;
  static constexpr std::size_t column_rows = 4;

  static Sum zero() noexcept { return {__v8si(_mm256_setzero_si256())}; }

  static Row row(const std::int8_t* from) noexcept {
    __m256i values = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    // Stays in a register: GCC would load it anew for every product.
    __asm__("" : "+x"(values));
    return {values};
  }

  static Query query(const std::int8_t* from) noexcept {
    const __m256i values = row(from).values;
    return {_mm256_abs_epi8(values), _mm256_cmpgt_epi8(_mm256_setzero_si256(), values)};
  }

  static Sum add(Sum sum, Row row, Query query) noexcept {
    const __m256i pairs =
        _mm256_maddubs_epi16(query.sizes, _mm256_xor_si256(row.values, query.signs));
    return {sum.lanes + __v8si(_mm256_madd_epi16(pairs, _mm256_set1_epi16(1)))};
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    store_totals({halves(sums[0]), halves(sums[1]), halves(sums[2]), halves(sums[3])}, out);
  }

 private:
  static __m128i halves(Sum sum) noexcept {
    const auto lanes = __m256i(sum.lanes);
    return _mm_add_epi32(_mm256_castsi256_si128(lanes), _mm256_extracti128_si256(lanes, 1));
  }
};

}  // namespace

std::uint32_t hamming_avx2(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept {
  return hamming<HighwayDifferences>(a, b, words);
}

void hamming_column_avx2(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept {
  hamming_column<HighwayDifferences>(query, rows, words, count, bits);
}

void sum_diagonals_avx2(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                        std::size_t stride, std::uint32_t* sums) noexcept {
  sum_diagonals<HighwayLanes>(values, window, count, stride, sums);
}

void lowest_lines_avx2(const std::uint32_t* sums, const std::uint32_t* changes,
                       const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                       std::size_t count, std::uint32_t* best, std::uint32_t* best_lines) noexcept {
  lowest_lines<HighwayLanes>(sums, changes, lines, line_count, number, count, best, best_lines);
}

void sketch_together_avx2(const std::uint8_t* both, const std::uint32_t* chosen, std::size_t words,
                          std::uint64_t* const* out) noexcept {
  sketches(both, chosen, words, out);
}

constinit const IntegerKernels avx2 = composed_of<Products, HighwayDifferences, HighwayLanes>(
    "avx2", &has_avx2, &sketch_together_avx2);

constinit const FloatKernels float_avx2{
    "avx2",
    &has_avx2,
    &dots,
    &dots_of_block<hwy::HWY_NAMESPACE::CappedTag<float, dot_lanes>, 3, 4>,
    &sum_diagonals<HighwayDoubles>,
    &lowest_lines<HighwayDoubles>};

}  // namespace seqloop::kernels
