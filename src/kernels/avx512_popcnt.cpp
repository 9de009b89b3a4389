// SPDX-License-Identifier: MIT
#include <immintrin.h>

#include "kernels/dots.hpp"
#include "kernels/hamming.hpp"
#include "kernels/variants.hpp"
#include "kernels/vnni512.hpp"

namespace seqloop::kernels {
namespace {

/// vpopcntq counts a block's bits at once; of half a block, it counts zeros behind it.
struct Differences {
  struct Sum {
    __m512i lanes;
  };

  static Sum zero() noexcept { return {_mm512_setzero_si512()}; }

  template <std::size_t words>
  static Sum add(Sum sum, const std::uint64_t* a, const std::uint64_t* b) noexcept {
    const __m512i differ = _mm512_xor_si512(load<words>(a), load<words>(b));
    return {_mm512_add_epi64(sum.lanes, _mm512_popcnt_epi64(differ))};
  }

  static std::uint32_t total(Sum sum) noexcept {
    const __m256i half = _mm256_add_epi64(_mm512_maskz_extracti64x4_epi64(all_lanes, sum.lanes, 0),
                                          _mm512_maskz_extracti64x4_epi64(all_lanes, sum.lanes, 1));
    const __m128i pair =
        _mm_add_epi64(_mm256_castsi256_si128(half), _mm256_extracti128_si256(half, 1));
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(pair) + _mm_extract_epi32(pair, 2));
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    store_quarters(
        added_pairs(packed(sums[0].lanes, sums[1].lanes), packed(sums[2].lanes, sums[3].lanes)),
        out);
  }

 private:
  template <std::size_t words>
  static __m512i load(const std::uint64_t* from) noexcept {
    constexpr auto lanes = static_cast<__mmask8>((1U << words) - 1);
    return _mm512_maskz_loadu_epi64(lanes, from);
  }

  /// Counts fit 32 bits: those of b go where a has zeros.
  static __m512i packed(__m512i a, __m512i b) noexcept {
    return _mm512_or_si512(a, _mm512_maskz_slli_epi64(all_lanes, b, 32));
  }
};

}  // namespace

constinit const IntegerKernels avx512_popcnt{
    "avx512-vnni-popcnt",         &has_avx512_popcnt,          &dot<Vnni512Products>,
    &dot_column<Vnni512Products>, &dot_block<Vnni512Products>, &hamming<Differences>,
    &hamming_column<Differences>, &sum_diagonals_avx512,       &lowest_lines_avx512,
    &sketch_together_avx512};

}  // namespace seqloop::kernels
