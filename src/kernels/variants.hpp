// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"

// Everything that some processor's build may have. Which of it is compiled, CMakeLists.txt says;
// which of that is listed, the processor family's variants_*.cpp.
namespace seqloop::kernels {

extern const IntegerKernels avx512_popcnt;
extern const IntegerKernels avx512_vnni;
extern const IntegerKernels avx512;
extern const IntegerKernels avx_vnni;
extern const IntegerKernels avx2;
extern const IntegerKernels sse4;
extern const IntegerKernels neon_dot;
extern const IntegerKernels neon;
extern const IntegerKernels scalar;

extern const FloatKernels float_avx512;
extern const FloatKernels float_avx2;
extern const FloatKernels float_neon;
extern const FloatKernels float_vfpv4;
extern const FloatKernels float_plain;

// What a variant shares with one that has fewer instructions. Not compiled again: the linker could
// take the copy with more of them for both.
std::uint32_t hamming_avx512(const std::uint64_t* a, const std::uint64_t* b,
                             std::size_t words) noexcept;
void hamming_column_avx512(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                           std::size_t count, std::uint32_t* bits) noexcept;
void sum_diagonals_avx512(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                          std::size_t stride, std::uint32_t* sums) noexcept;
void lowest_lines_avx512(const std::uint32_t* sums, const std::uint32_t* changes,
                         const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                         std::size_t count, std::uint32_t* best,
                         std::uint32_t* best_lines) noexcept;
void sketch_together_avx512(const std::uint8_t* both, const std::uint32_t* chosen,
                            std::size_t words, std::uint64_t* const* out) noexcept;
std::uint32_t hamming_avx2(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept;
void hamming_column_avx2(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept;
void sum_diagonals_avx2(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                        std::size_t stride, std::uint32_t* sums) noexcept;
void lowest_lines_avx2(const std::uint32_t* sums, const std::uint32_t* changes,
                       const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                       std::size_t count, std::uint32_t* best, std::uint32_t* best_lines) noexcept;
void sketch_together_avx2(const std::uint8_t* both, const std::uint32_t* chosen, std::size_t words,
                          std::uint64_t* const* out) noexcept;
std::uint32_t hamming_neon(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept;
void hamming_column_neon(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept;
void sum_diagonals_neon(const std::uint16_t* const* values, std::size_t window, std::size_t count,
                        std::size_t stride, std::uint32_t* sums) noexcept;
void lowest_lines_neon(const std::uint32_t* sums, const std::uint32_t* changes,
                       const LineThroughSums* lines, std::size_t line_count, std::uint32_t number,
                       std::size_t count, std::uint32_t* best, std::uint32_t* best_lines) noexcept;
void sketch_together_neon(const std::uint8_t* both, const std::uint32_t* chosen, std::size_t words,
                          std::uint64_t* const* out) noexcept;

// What the processor can do. Defined in files that are compiled for every processor of the family.
[[nodiscard]] bool has_avx512_popcnt() noexcept;
[[nodiscard]] bool has_avx512_vnni() noexcept;
[[nodiscard]] bool has_avx512() noexcept;
[[nodiscard]] bool has_avx_vnni() noexcept;
[[nodiscard]] bool has_avx2() noexcept;
[[nodiscard]] bool has_sse4() noexcept;
[[nodiscard]] bool has_neon_dot() noexcept;
[[nodiscard]] bool has_neon() noexcept;

}  // namespace seqloop::kernels
