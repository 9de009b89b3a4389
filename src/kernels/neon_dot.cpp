#include <arm_neon.h>

#include "kernels/blocks.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

struct Products {
  struct Sum {
    int32x4_t even;
    int32x4_t odd;
  };
  static constexpr std::uint32_t row_offset = 0;

  static Sum zero() noexcept { return {vdupq_n_s32(0), vdupq_n_s32(0)}; }

  static Sum add(Sum sum, const std::int8_t* row, const std::int8_t* query) noexcept {
    for (std::size_t i = 0; i < row_bytes; i += 32) {
      sum.even = vdotq_s32(sum.even, vld1q_s8(row + i), vld1q_s8(query + i));
      sum.odd = vdotq_s32(sum.odd, vld1q_s8(row + i + 16), vld1q_s8(query + i + 16));
    }
    return sum;
  }

  static int32x4_t four_lanes(Sum sum) noexcept { return vaddq_s32(sum.even, sum.odd); }

  static std::uint32_t total(Sum sum) noexcept {
    return static_cast<std::uint32_t>(vaddvq_s32(four_lanes(sum)));
  }

  static void store_totals(const Sum (&sums)[rows_abreast], std::uint32_t /*too_much*/,
                           std::int32_t* out) noexcept {
    const int32x4_t first = vpaddq_s32(four_lanes(sums[0]), four_lanes(sums[1]));
    const int32x4_t last = vpaddq_s32(four_lanes(sums[2]), four_lanes(sums[3]));
    vst1q_s32(out, vpaddq_s32(first, last));
  }
};

}  // namespace

constinit const IntegerKernels neon_dot{"neon-dot",     &has_neon_dot,
                                        &dot<Products>, &dot_column<Products>,
                                        &hamming_neon,  &hamming_column_neon};

}  // namespace seqloop::kernels
