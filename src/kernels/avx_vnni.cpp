#include <immintrin.h>

#include "kernels/blocks.hpp"
#include "kernels/four_sums.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

/// vpdpbusd multiplies unsigned values by signed ones: the row's are made unsigned by adding 128.
struct Products {
  struct Sum {
    __m256i low;
    __m256i high;
  };
  static constexpr std::uint32_t row_offset = 128;

  static Sum zero() noexcept { return {_mm256_setzero_si256(), _mm256_setzero_si256()}; }

  static __m256i load(const std::int8_t* values) noexcept {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values));
  }

  static __m256i load_unsigned(const std::int8_t* values) noexcept {
    return _mm256_xor_si256(load(values), _mm256_set1_epi8(-128));
  }

  static Sum add(Sum sum, const std::int8_t* row, const std::int8_t* query) noexcept {
    return {_mm256_dpbusd_avx_epi32(sum.low, load_unsigned(row), load(query)),
            _mm256_dpbusd_avx_epi32(sum.high, load_unsigned(row + 32), load(query + 32))};
  }

  static __m128i four_lanes(Sum sum) noexcept {
    const __m256i eight = _mm256_add_epi32(sum.low, sum.high);
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

constinit const IntegerKernels avx_vnni{"avx-vnni",     &has_avx_vnni,
                                        &dot<Products>, &dot_column<Products>,
                                        &hamming_avx2,  &hamming_column_avx2};

}  // namespace seqloop::kernels
