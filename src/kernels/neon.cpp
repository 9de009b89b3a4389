#include "kernels/blocks.hpp"
#include "kernels/highway.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {

std::uint32_t hamming_neon(const std::uint64_t* a, const std::uint64_t* b,
                           std::size_t words) noexcept {
  return hamming<HighwayDifferences>(a, b, words);
}

void hamming_column_neon(const std::uint64_t* query, const std::uint64_t* rows, std::size_t words,
                         std::size_t count, std::uint32_t* out) noexcept {
  hamming_column<HighwayDifferences>(query, rows, words, count, out);
}

constinit const IntegerKernels neon =
    made_of<HighwayProducts, HighwayDifferences>("neon", &has_neon);

}  // namespace seqloop::kernels
