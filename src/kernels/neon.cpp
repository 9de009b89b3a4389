// SPDX-License-Identifier: MIT
#include "kernels/composed_of.hpp"
#ifdef __aarch64__
#include "kernels/float_dots.hpp"
#endif
#include "kernels/highway.hpp"
#include "kernels/neon_bytes.hpp"
#include "kernels/sketches.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

/// Products of bytes fit 16 bits, and so do sums of two of them as long as no value is -128: only
/// these are widened.
struct Products : NeonBytes {
  static constexpr std::size_t block_queries = 4;
  static constexpr std::size_t column_rows = 4;

  static Sum add(Sum sum, Row row, Query query) noexcept {
    const int16x8_t first = vmull_s8(vget_low_s8(row), vget_low_s8(query));
#ifdef __aarch64__  // takes the upper halves where they are
    return vpadalq_s16(sum, vmlal_high_s8(first, row, query));
#else
    return vpadalq_s16(sum, vmlal_s8(first, vget_high_s8(row), vget_high_s8(query)));
#endif
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    // As 32-bit ARM can, too: pairs of half a register.
    const int32x4_t four = vcombine_s32(vpadd_s32(halves(sums[0]), halves(sums[1])),
                                        vpadd_s32(halves(sums[2]), halves(sums[3])));
    vst1q_u32(out, vreinterpretq_u32_s32(four));
  }

 private:
  static int32x2_t halves(Sum sum) noexcept {
    return vadd_s32(vget_low_s32(sum), vget_high_s32(sum));
  }
};

}  // namespace

std::uint32_t hamming_neon(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept {
  return hamming<HighwayDifferences>(a, b, words);
}

void hamming_column_neon(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept {
  hamming_column<HighwayDifferences>(query, rows, words, count, bits);
}

void sum_diagonals_neon(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                        std::size_t stride, std::uint32_t* sums) noexcept {
  sum_diagonals<HighwayLanes>(values, window, count, stride, sums);
}

void lowest_lines_neon(const std::uint32_t* sums, const std::uint32_t* changes,
                       const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                       std::size_t count, std::uint32_t* best, std::uint32_t* best_lines) noexcept {
  lowest_lines<HighwayLanes>(sums, changes, lines, line_count, number, count, best, best_lines);
}

void sketch_together_neon(const std::uint8_t* both, const std::uint32_t* chosen, std::size_t words,
                          std::uint64_t* const* out) noexcept {
  sketches(both, chosen, words, out);
}

constinit const IntegerKernels neon = composed_of<Products, HighwayDifferences, HighwayLanes>(
    "neon", &has_neon, &sketch_together_neon);

#ifdef __aarch64__  // 32-bit ARM: float_vfpv4.cpp
constinit const FloatKernels float_neon{
    "neon",
    &has_neon,
    &dots,
    &dots_of_block<hwy::HWY_NAMESPACE::CappedTag<float, 4>, 4, 4>,
    &sum_diagonals<HighwayDoubles>,
    &lowest_lines<HighwayDoubles>};
#endif

}  // namespace seqloop::kernels
