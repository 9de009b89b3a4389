#include <bit>

#include "kernels/blocks.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

struct Products {
  using Sum = std::int32_t;
  static constexpr std::uint32_t row_offset = 0;
  static Sum zero() noexcept { return 0; }
  static Sum add(Sum sum, const std::int8_t* row, const std::int8_t* query) noexcept {
    for (std::size_t i = 0; i < row_bytes; ++i) sum += row[i] * query[i];
    return sum;
  }
  static std::uint32_t total(Sum sum) noexcept { return static_cast<std::uint32_t>(sum); }

  static void store_totals(const Sum (&sums)[rows_abreast], std::uint32_t /*too_much*/,
                           std::int32_t* out) noexcept {
    for (std::size_t row = 0; row < rows_abreast; ++row) {
      out[row] = static_cast<std::int32_t>(total(sums[row]));
    }
  }
};

struct Differences {
  using Sum = std::uint32_t;
  static Sum zero() noexcept { return 0; }
  static Sum add(Sum sum, const std::uint64_t* a, const std::uint64_t* b) noexcept {
    for (std::size_t i = 0; i < words_per_block; ++i) {
      sum += static_cast<std::uint32_t>(std::popcount(a[i] ^ b[i]));
    }
    return sum;
  }
  static std::uint32_t total(Sum sum) noexcept { return sum; }
};

bool always() noexcept { return true; }

}  // namespace

constinit const IntegerKernels scalar = made_of<Products, Differences>("scalar", &always);

}  // namespace seqloop::kernels
