// SPDX-License-Identifier: MIT
#include <cpuid.h>

#include <array>

#include "kernels/variants.hpp"

namespace seqloop {
namespace kernels {

bool has_sse4() noexcept {
  __builtin_cpu_init();
  return __builtin_cpu_supports("sse4.2") != 0 && __builtin_cpu_supports("popcnt") != 0;
}

bool has_avx2() noexcept {
  return has_sse4() && __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
         __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0;
}

bool has_avx_vnni() noexcept {
  if (!has_avx2()) return false;
  // Clang 14 does not know this one by name.
  constexpr unsigned avx_vnni_bit = 1U << 4U;
  unsigned eax = 0;
  unsigned ebx = 0;
  unsigned ecx = 0;
  unsigned edx = 0;
  return __get_cpuid_count(7, 1, &eax, &ebx, &ecx, &edx) != 0 && (eax & avx_vnni_bit) != 0;
}

bool has_avx512() noexcept {
  return has_avx2() && __builtin_cpu_supports("avx512f") != 0 &&
         __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0;
}

bool has_avx512_vnni() noexcept {
  return has_avx512() && __builtin_cpu_supports("avx512vnni") != 0;
}

bool has_avx512_popcnt() noexcept {
  return has_avx512_vnni() && __builtin_cpu_supports("avx512vpopcntdq") != 0;
}

}  // namespace kernels

std::span<const IntegerKernels* const> integer_kernels() noexcept {
  static constexpr std::array variants{
      &kernels::avx512_popcnt, &kernels::avx512_vnni, &kernels::avx_vnni, &kernels::avx512,
      &kernels::avx2,          &kernels::sse4,        &kernels::scalar};
  return variants;
}

std::span<const FloatKernels* const> float_kernels() noexcept {
  static constexpr std::array variants{&kernels::float_avx512, &kernels::float_avx2,
                                       &kernels::float_plain};
  return variants;
}

}  // namespace seqloop
