// SPDX-License-Identifier: MIT
#include <array>

#include "kernels/variants.hpp"

namespace seqloop {

std::span<const IntegerKernels* const> integer_kernels() noexcept {
  static constexpr std::array variants{&kernels::scalar};
  return variants;
}

std::span<const FloatKernels* const> float_kernels() noexcept {
  static constexpr std::array variants{&kernels::float_plain};
  return variants;
}

}  // namespace seqloop
