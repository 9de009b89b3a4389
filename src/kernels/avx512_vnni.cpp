#include <immintrin.h>

#include "kernels/blocks.hpp"
#include "kernels/four_sums.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

/// vpdpbusd multiplies unsigned values by signed ones: the row's are made unsigned by adding 128.
struct Products {
  struct Sum {
    __m512i lanes;
  };
  static constexpr std::uint32_t row_offset = 128;

  static Sum zero() noexcept { return {_mm512_setzero_si512()}; }

  static Sum add(Sum sum, const std::int8_t* row, const std::int8_t* query) noexcept {
    const __m512i shifted = _mm512_xor_si512(_mm512_loadu_si512(row), _mm512_set1_epi8(-128));
    return {_mm512_dpbusd_epi32(sum.lanes, shifted, _mm512_loadu_si512(query))};
  }

  static __m128i four_lanes(Sum sum) noexcept {
    // With a mask of all lanes, because GCC 12 warns of its own intrinsics without one.
    const __m256i lower = _mm512_maskz_extracti64x4_epi64(0xF, sum.lanes, 0);
    const __m256i upper = _mm512_maskz_extracti64x4_epi64(0xF, sum.lanes, 1);
    const __m256i eight = _mm256_add_epi32(lower, upper);
    return _mm_add_epi32(_mm256_castsi256_si128(eight), _mm256_extracti128_si256(eight, 1));
  }

  static std::uint32_t total(Sum sum) noexcept { return sum_of(four_lanes(sum)); }

  static void store_totals(const Sum (&sums)[rows_abreast], std::uint32_t too_much,
                           std::int32_t* out) noexcept {
    store_four_sums(
        {four_lanes(sums[0]), four_lanes(sums[1]), four_lanes(sums[2]), four_lanes(sums[3])},
        too_much, out);
  }
};

}  // namespace

constinit const IntegerKernels avx512_vnni{"avx512-vnni",   &has_avx512_vnni,
                                           &dot<Products>,  &dot_column<Products>,
                                           &hamming_avx512, &hamming_column_avx512};

}  // namespace seqloop::kernels
