// SPDX-License-Identifier: MIT
// A program that this file is linked into takes the kernels that SEQLOOP_KERNELS names, so that one
// machine can stand in for lesser ones; without that, the best. These functions stand in for the
// library's own.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"

namespace seqloop {
namespace {

const char* wanted() noexcept { return std::getenv("SEQLOOP_KERNELS"); }

}  // namespace

const IntegerKernels& best_integer_kernels() noexcept {
  const char* const name = wanted();
  for (const IntegerKernels* kernels : integer_kernels()) {
    if (kernels->supported() && (name == nullptr || kernels->name == std::string_view(name))) {
      return *kernels;
    }
  }
  std::fprintf(stderr, "SEQLOOP_KERNELS: '%s' are no kernels that run here, which are", name);
  for (const IntegerKernels* kernels : integer_kernels()) {
    if (kernels->supported()) std::fprintf(stderr, " %s", kernels->name.data());
  }
  std::fprintf(stderr, "\n");
  std::exit(2);
}

/// There are fewer of floats: those whose name the wanted one begins with ("avx512" for
/// "avx512-vnni"), or those in plain C++.
const FloatKernels& best_float_kernels() noexcept {
  const char* const name = wanted();
  for (const FloatKernels* kernels : float_kernels()) {
    if (kernels->supported() &&
        (name == nullptr || std::string_view(name).starts_with(kernels->name))) {
      return *kernels;
    }
  }
  return *float_kernels().back();
}

}  // namespace seqloop
