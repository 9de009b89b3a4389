// SPDX-License-Identifier: MIT
#include <arm_neon.h>

#include "kernels/dots.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

struct Products {
  using Sum = int32x4_t;
  using Row = int8x16_t;
  using Query = int8x16_t;
  static constexpr std::size_t step = 16;
  static constexpr std::uint32_t row_offset = 0;
  static constexpr std::size_t block_queries = 8;
  static constexpr std::size_t block_rows = 2;
  static constexpr std::size_t column_rows = 8;

  static Sum zero() noexcept { return vdupq_n_s32(0); }
  static Row row(const std::int8_t* from) noexcept { return vld1q_s8(from); }
  static Query query(const std::int8_t* from) noexcept { return vld1q_s8(from); }
  static Sum add(Sum sum, Row row, Query query) noexcept { return vdotq_s32(sum, row, query); }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    const int32x4_t first = vpaddq_s32(sums[0], sums[1]);
    const int32x4_t last = vpaddq_s32(sums[2], sums[3]);
    vst1q_u32(out, vreinterpretq_u32_s32(vpaddq_s32(first, last)));
  }
};

}  // namespace

constinit const IntegerKernels neon_dot{
    "neon-dot",           &has_neon_dot, &dot<Products>,       &dot_column<Products>,
    &dot_block<Products>, &hamming_neon, &hamming_column_neon, &sum_diagonals_neon,
    &lowest_lines_neon};

}  // namespace seqloop::kernels
