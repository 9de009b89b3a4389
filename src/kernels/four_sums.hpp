// SPDX-License-Identifier: MIT
#pragma once

#include <immintrin.h>

#include <cstdint>

namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// Adds up four sums that are spread over four lanes each; modulo 2^32, unlike the intrinsics that
/// reduce, which leave undefined what happens beyond 31 bits.
/// @param out [4]
inline void store_totals(const __m128i (&sums)[4], std::uint32_t* out) noexcept {
  const __m128i totals =
      _mm_hadd_epi32(_mm_hadd_epi32(sums[0], sums[1]), _mm_hadd_epi32(sums[2], sums[3]));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(out), totals);
}

}  // namespace
}  // namespace seqloop::kernels
