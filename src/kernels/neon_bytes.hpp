// SPDX-License-Identifier: MIT
#pragma once

#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// How all NEON kernels read bytes, and what they add them up in; they differ in how they multiply.
struct NeonBytes {
  using Sum = int32x4_t;
  using Row = int8x16_t;
  using Query = int8x16_t;
  static constexpr std::size_t step = 16;
  static constexpr bool exceeds = false;
  static constexpr std::size_t block_rows = 2;

  static Sum zero() noexcept { return vdupq_n_s32(0); }
  static Row row(const std::int8_t* from) noexcept { return vld1q_s8(from); }
  static Query query(const std::int8_t* from) noexcept { return vld1q_s8(from); }
};

}  // namespace
}  // namespace seqloop::kernels
