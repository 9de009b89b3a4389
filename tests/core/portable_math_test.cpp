// SPDX-License-Identifier: MIT
// Functions that give the same bytes on every processor.
#include "seqloop/detail/portable_math.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

namespace seqloop {
namespace {

TEST(PortableMath, IsAsExactAsTheLibrarys) {
  for (double x = -699.0; x < 700.0; x += 0.37) {
    EXPECT_NEAR(exponential(x) / std::exp(x), 1.0, 1e-14) << x;
  }
  for (double x = 1e-300; x < 1e300; x *= 1.9) {
    EXPECT_NEAR(logarithm(x), std::log(x), 1e-14 * std::max(1.0, std::abs(std::log(x)))) << x;
  }
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(logarithm(1.0), 0.0);
  EXPECT_EQ(logistic(0.0), 0.5);
}

TEST(PortableMath, NeverLeavesTheNumbers) {
  EXPECT_TRUE(std::isnormal(exponential(-1e9)));
  EXPECT_TRUE(std::isnormal(exponential(1e9)));
  EXPECT_GE(logistic(-1e9), 0.0);
  EXPECT_LE(logistic(1e9), 1.0);
}

// Bytes that were written down: another processor, compiler or optimisation must not change them.
TEST(PortableMath, GivesTheSameBytesEverywhere) {
  std::uint64_t mixed = 0;
  for (int i = -2000; i <= 2000; ++i) {
    const double x = i * 0.171;
    mixed = std::rotl(mixed, 7) ^ std::bit_cast<std::uint64_t>(exponential(x));
    mixed = std::rotl(mixed, 7) ^ std::bit_cast<std::uint64_t>(logarithm(1e-3 + x * x));
  }
  EXPECT_EQ(mixed, 15118218978039821170ULL);
}

}  // namespace
}  // namespace seqloop
