// SPDX-License-Identifier: MIT
#include <sys/auxv.h>

#include <array>

#include "kernels/variants.hpp"

namespace seqloop {
namespace kernels {

bool has_neon() noexcept {
  constexpr unsigned long bits = (1UL << 12U) | (1UL << 16U);  // HWCAP_NEON, HWCAP_VFPv4
  return (getauxval(AT_HWCAP) & bits) == bits;
}

}  // namespace kernels

std::span<const IntegerKernels* const> integer_kernels() noexcept {
  static constexpr std::array variants{&kernels::neon, &kernels::scalar};
  return variants;
}

std::span<const FloatKernels* const> float_kernels() noexcept {
  static constexpr std::array variants{&kernels::float_vfpv4, &kernels::float_plain};
  return variants;
}

}  // namespace seqloop
