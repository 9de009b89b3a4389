// SPDX-License-Identifier: MIT
#include "kernels/dots.hpp"
#include "kernels/neon_bytes.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

struct Products : NeonBytes {
  static constexpr std::size_t block_queries = 8;
  static constexpr std::size_t column_rows = 8;

  static Sum add(Sum sum, Row row, Query query) noexcept { return vdotq_s32(sum, row, query); }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    const int32x4_t first = vpaddq_s32(sums[0], sums[1]);
    const int32x4_t last = vpaddq_s32(sums[2], sums[3]);
    vst1q_u32(out, vreinterpretq_u32_s32(vpaddq_s32(first, last)));
  }
};

}  // namespace

constinit const IntegerKernels neon_dot{
    "neon-dot",           &has_neon_dot,        &dot<Products>,       &dot_column<Products>,
    &dot_block<Products>, &hamming_neon,        &hamming_column_neon, &sum_diagonals_neon,
    &lowest_lines_neon,   &sketch_together_neon};

}  // namespace seqloop::kernels
