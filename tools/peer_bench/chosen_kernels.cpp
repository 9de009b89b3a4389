// SPDX-License-Identifier: MIT
// A program that this file is linked into takes the kernels that SEQLOOP_KERNELS names, so that one
// machine can stand in for lesser ones; without that, the best. The function stands in for the
// library's own.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "seqloop/detail/integer_kernels.hpp"

namespace seqloop {

const IntegerKernels& best_integer_kernels() noexcept {
  const char* wanted = std::getenv("SEQLOOP_KERNELS");
  for (const IntegerKernels* kernels : integer_kernels()) {
    if (kernels->supported() && (wanted == nullptr || kernels->name == std::string_view(wanted))) {
      return *kernels;
    }
  }
  std::fprintf(stderr, "SEQLOOP_KERNELS: '%s' are no kernels that run here, which are", wanted);
  for (const IntegerKernels* kernels : integer_kernels()) {
    if (kernels->supported()) std::fprintf(stderr, " %s", kernels->name.data());
  }
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace seqloop
