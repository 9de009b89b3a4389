// SPDX-License-Identifier: MIT
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "kernels/blocks.hpp"

namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

// GCC 12 warns of its own AVX-512 intrinsics without a mask, so they get one of all lanes.
inline constexpr __mmask8 all_lanes = 0xFF;

/// Adds up the four quarters.
/// @param out [4]
inline void store_quarters(__m512i sums, std::uint32_t* out) noexcept {
  const __m256i lower = _mm512_maskz_extracti64x4_epi64(all_lanes, sums, 0);
  const __m256i upper = _mm512_maskz_extracti64x4_epi64(all_lanes, sums, 1);
  const __m256i eight = _mm256_add_epi32(lower, upper);
  const __m128i four =
      _mm_add_epi32(_mm256_castsi256_si128(eight), _mm256_extracti128_si256(eight, 1));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(out), four);
}

/// In every quarter, the sum of what two vectors have at even places and the same at odd ones.
inline __m512i added_pairs(__m512i a, __m512i b) noexcept {
  return _mm512_add_epi32(_mm512_maskz_unpacklo_epi64(all_lanes, a, b),
                          _mm512_maskz_unpackhi_epi64(all_lanes, a, b));
}

/// vpdpbusd multiplies unsigned values by signed ones: the row's are made unsigned by adding 128.
struct Vnni512Products {
  // Not __m512i: GCC 12 would copy every sum from type to type in the loop.
  struct Sum {
    __v16si lanes;
  };
  struct Row {
    __m512i shifted;
  };
  struct Query {
    __m512i values;
  };
  static constexpr std::size_t step = 64;
  static constexpr bool exceeds = true;
  static constexpr std::size_t block_queries = 8;
  static constexpr std::size_t block_rows = 3;
  static constexpr std::size_t column_rows = 8;

  static Sum zero() noexcept { return {__v16si(_mm512_setzero_si512())}; }

  static Row row(const std::int8_t* from) noexcept {
    return {_mm512_xor_si512(_mm512_loadu_si512(from), _mm512_set1_epi8(-128))};
  }

  static Query query(const std::int8_t* from) noexcept {
    __m512i values = _mm512_loadu_si512(from);
    // Stays in a register: GCC would load it anew for every product.
    __asm__("" : "+v"(values));
    return {values};
  }

  static Sum add(Sum sum, Row row, Query query) noexcept {
    return {__v16si(_mm512_dpbusd_epi32(__m512i(sum.lanes), row.shifted, query.values))};
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    store_quarters(added_pairs(interleaved(__m512i(sums[0].lanes), __m512i(sums[1].lanes)),
                               interleaved(__m512i(sums[2].lanes), __m512i(sums[3].lanes))),
                   out);
  }

 private:
  /// Lanes of a at even places, of b at odd ones, two of each added up.
  static __m512i interleaved(__m512i a, __m512i b) noexcept {
    constexpr __mmask16 all = 0xFFFF;
    return _mm512_add_epi32(_mm512_maskz_unpacklo_epi32(all, a, b),
                            _mm512_maskz_unpackhi_epi32(all, a, b));
  }
};

}  // namespace
}  // namespace seqloop::kernels
