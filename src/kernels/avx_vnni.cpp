// SPDX-License-Identifier: MIT
#include <immintrin.h>

#include "kernels/dots.hpp"
#include "kernels/four_sums.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

/// vpdpbusd multiplies unsigned values by signed ones: the row's are made unsigned by adding 128.
struct Products {
  struct Sum {
    __m256i lanes;
  };
  struct Row {
    __m256i shifted;
  };
  struct Query {
    __m256i values;
  };
  static constexpr std::size_t step = 32;
  static constexpr bool exceeds = true;
  static constexpr std::size_t block_queries = 4;
  static constexpr std::size_t block_rows = 2;
  static constexpr std::size_t column_rows = 8;

  static Sum zero() noexcept { return {_mm256_setzero_si256()}; }

  static Row row(const std::int8_t* from) noexcept {
    return {_mm256_xor_si256(query(from).values, _mm256_set1_epi8(-128))};
  }

  static Query query(const std::int8_t* from) noexcept {
    return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from))};
  }

  static Sum add(Sum sum, Row row, Query query) noexcept {
    return {_mm256_dpbusd_avx_epi32(sum.lanes, row.shifted, query.values)};
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    store_totals({halves(sums[0]), halves(sums[1]), halves(sums[2]), halves(sums[3])}, out);
  }

 private:
  static __m128i halves(Sum sum) noexcept {
    return _mm_add_epi32(_mm256_castsi256_si128(sum.lanes), _mm256_extracti128_si256(sum.lanes, 1));
  }
};

}  // namespace

constinit const IntegerKernels avx_vnni{
    "avx-vnni",           &has_avx_vnni,        &dot<Products>,       &dot_column<Products>,
    &dot_block<Products>, &hamming_avx2,        &hamming_column_avx2, &sum_diagonals_avx2,
    &lowest_lines_avx2,   &sketch_together_avx2};

}  // namespace seqloop::kernels
