// SPDX-License-Identifier: MIT
#include <bit>

#include "kernels/composed_of.hpp"
#include "kernels/variants.hpp"
#include "seqloop/detail/sketch.hpp"

namespace seqloop::kernels {
namespace {

struct Products {
  using Sum = std::int32_t;
  using Row = const std::int8_t*;
  using Query = const std::int8_t*;
  static constexpr std::size_t step = 64;
  static constexpr bool exceeds = false;
  static constexpr std::size_t block_queries = 1;
  static constexpr std::size_t block_rows = 2;
  static constexpr std::size_t column_rows = 4;

  static Sum zero() noexcept { return 0; }
  static Row row(const std::int8_t* from) noexcept { return from; }
  static Query query(const std::int8_t* from) noexcept { return from; }

  static Sum add(Sum sum, Row row, Query query) noexcept {
    for (std::size_t i = 0; i < step; ++i) sum += row[i] * query[i];
    return sum;
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    for (std::size_t i = 0; i < sums_together; ++i) out[i] = static_cast<std::uint32_t>(sums[i]);
  }
};

struct Differences {
  using Sum = std::uint32_t;
  static Sum zero() noexcept { return 0; }
  template <std::size_t words>
  static Sum add(Sum sum, const std::uint64_t* a, const std::uint64_t* b) noexcept {
    for (std::size_t i = 0; i < words; ++i) {
      sum += static_cast<std::uint32_t>(std::popcount(a[i] ^ b[i]));
    }
    return sum;
  }
  static std::uint32_t total(Sum sum) noexcept { return sum; }
  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    for (std::size_t i = 0; i < sums_together; ++i) out[i] = sums[i];
  }
};

bool always() noexcept { return true; }

}  // namespace

constinit const IntegerKernels scalar =
    composed_of<Products, Differences, OneLane<Products, std::uint16_t, std::uint32_t>>(
        "scalar", &always, &sketch_together);

}  // namespace seqloop::kernels
