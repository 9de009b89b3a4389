// SPDX-License-Identifier: MIT
#include "seqloop/detail/integer_kernels.hpp"

#include <algorithm>

namespace seqloop {

const IntegerKernels& best_integer_kernels() noexcept {
  // The last one is in plain C++, so that one is always found.
  return **std::ranges::find_if(integer_kernels(),
                                [](const IntegerKernels* kernels) { return kernels->supported(); });
}

}  // namespace seqloop
