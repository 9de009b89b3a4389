// SPDX-License-Identifier: MIT
#include <algorithm>
#include <span>

#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"

namespace seqloop {
namespace {

/// The last one is in plain C++, so that one is always found.
template <class Kernels>
const Kernels& first_supported(std::span<const Kernels* const> variants) noexcept {
  return **std::ranges::find_if(variants,
                                [](const Kernels* kernels) { return kernels->supported(); });
}

}  // namespace

const IntegerKernels& best_integer_kernels() noexcept { return first_supported(integer_kernels()); }

const FloatKernels& best_float_kernels() noexcept { return first_supported(float_kernels()); }

}  // namespace seqloop
