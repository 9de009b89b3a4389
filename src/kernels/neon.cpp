#include "kernels/highway.hpp"
#include "kernels/made_of.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {

std::uint32_t hamming_neon(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept {
  return hamming<HighwayDifferences>(a, b, words);
}

void hamming_column_neon(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* bits) noexcept {
  hamming_column<HighwayDifferences>(query, rows, words, count, bits);
}

void add_column_neon(const std::uint32_t* before, const std::uint16_t* values, std::size_t count,
                     std::uint32_t* after) noexcept {
  add_column<HighwayLanes>(before, values, count, after);
}

void lowest_lines_neon(const std::uint32_t* prefix, const LineSegment* segments,
                       std::size_t segment_count, std::size_t count, std::uint32_t line,
                       std::uint32_t* best, std::uint32_t* lines) noexcept {
  lowest_lines<HighwayLanes>(prefix, segments, segment_count, count, line, best, lines);
}

constinit const IntegerKernels neon =
    made_of<HighwayProducts, HighwayDifferences, HighwayLanes>("neon", &has_neon);

}  // namespace seqloop::kernels
