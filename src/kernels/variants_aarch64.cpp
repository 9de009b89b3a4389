// SPDX-License-Identifier: MIT
#include <sys/auxv.h>

#include <array>

#include "kernels/variants.hpp"

namespace seqloop {
namespace kernels {

bool has_neon() noexcept { return true; }

bool has_neon_dot() noexcept {
  constexpr unsigned long dot_product_bit = 1UL << 20U;  // HWCAP_ASIMDDP
  return (getauxval(AT_HWCAP) & dot_product_bit) != 0;
}

}  // namespace kernels

std::span<const IntegerKernels* const> integer_kernels() noexcept {
  static constexpr std::array variants{&kernels::neon_dot, &kernels::neon, &kernels::scalar};
  return variants;
}

std::span<const FloatKernels* const> float_kernels() noexcept {
  static constexpr std::array variants{&kernels::float_neon, &kernels::float_plain};
  return variants;
}

}  // namespace seqloop
