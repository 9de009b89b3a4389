// SPDX-License-Identifier: MIT
#include "kernels/composed_of.hpp"
#include "kernels/float_dots.hpp"
#include "kernels/highway.hpp"
#include "kernels/sketches.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {

std::uint32_t hamming_avx512(const std::uint64_t* a, const std::uint64_t* b,
                             std::size_t words) noexcept {
  return hamming<HighwayDifferences>(a, b, words);
}

void hamming_column_avx512(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                           std::size_t count, std::uint32_t* bits) noexcept {
  hamming_column<HighwayDifferences>(query, rows, words, count, bits);
}

void sum_diagonals_avx512(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                          std::size_t stride, std::uint32_t* sums) noexcept {
  sum_diagonals<HighwayLanes>(values, window, count, stride, sums);
}

void lowest_lines_avx512(const std::uint32_t* sums, const std::uint32_t* changes,
                         const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                         std::size_t count, std::uint32_t* best,
                         std::uint32_t* best_lines) noexcept {
  lowest_lines<HighwayLanes>(sums, changes, lines, line_count, number, count, best, best_lines);
}

void sketch_together_avx512(const std::uint8_t* both, const std::uint32_t* chosen,
                            std::size_t words, std::uint64_t* const* out) noexcept {
  sketches(both, chosen, words, out);
}

constinit const IntegerKernels avx512 =
    composed_of<HighwayProducts, HighwayDifferences, HighwayLanes>("avx512", &has_avx512,
                                                                   &sketch_together_avx512);

constinit const FloatKernels float_avx512{
    "avx512",
    &has_avx512,
    &dots,
    &dots_of_block<hwy::HWY_NAMESPACE::CappedTag<float, 2 * dot_lanes>, 4, 4>,
    &sum_diagonals<HighwayDoubles>,
    &lowest_lines<HighwayDoubles>};

}  // namespace seqloop::kernels
