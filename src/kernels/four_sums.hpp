#pragma once

#include <immintrin.h>

#include <cstdint>

namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// Adds up what four rows keep in four lanes each; modulo 2^32, unlike the intrinsics that reduce,
/// which leave undefined what happens beyond 31 bits. Together they cost little more than one.
/// @param too_much subtracted from each   @param out [4]
inline void store_four_sums(const __m128i (&rows)[4], std::uint32_t too_much,
                            std::int32_t* out) noexcept {
  const __m128i sums =
      _mm_hadd_epi32(_mm_hadd_epi32(rows[0], rows[1]), _mm_hadd_epi32(rows[2], rows[3]));
  const __m128i less = _mm_sub_epi32(sums, _mm_set1_epi32(static_cast<std::int32_t>(too_much)));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(out), less);
}

/// The same of one row.
inline std::uint32_t sum_of(__m128i row) noexcept {
  const __m128i two = _mm_hadd_epi32(row, row);
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_hadd_epi32(two, two)));
}

}  // namespace
}  // namespace seqloop::kernels
