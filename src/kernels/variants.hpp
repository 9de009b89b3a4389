#pragma once

#include <cstddef>
#include <cstdint>

#include "seqloop/integer_kernels.hpp"

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

// What a variant shares with one that has fewer instructions. Not compiled again: the linker could
// take the copy with more of them for both.
std::uint32_t hamming_avx512(const std::uint64_t* a, const std::uint64_t* b,
                             std::size_t words) noexcept;
void hamming_column_avx512(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                           std::size_t count, std::uint32_t* bits) noexcept;
void add_column_avx512(const std::uint32_t* before, const std::uint16_t* values, std::size_t count,
                       std::uint32_t* after) noexcept;
void lowest_lines_avx512(const std::uint32_t* prefix, const LineSegment* segments,
                         std::size_t segment_count, std::size_t count, std::uint32_t line,
                         std::uint32_t* best, std::uint32_t* lines) noexcept;
std::uint32_t hamming_avx2(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept;
void hamming_column_avx2(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept;
void add_column_avx2(const std::uint32_t* before, const std::uint16_t* values, std::size_t count,
                     std::uint32_t* after) noexcept;
void lowest_lines_avx2(const std::uint32_t* prefix, const LineSegment* segments,
                       std::size_t segment_count, std::size_t count, std::uint32_t line,
                       std::uint32_t* best, std::uint32_t* lines) noexcept;
std::uint32_t hamming_neon(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept;
void hamming_column_neon(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept;
void add_column_neon(const std::uint32_t* before, const std::uint16_t* values, std::size_t count,
                     std::uint32_t* after) noexcept;
void lowest_lines_neon(const std::uint32_t* prefix, const LineSegment* segments,
                       std::size_t segment_count, std::size_t count, std::uint32_t line,
                       std::uint32_t* best, std::uint32_t* lines) noexcept;

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
