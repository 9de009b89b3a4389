// SPDX-License-Identifier: MIT
#include "seqloop/detail/portable_math.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace seqloop {
namespace {

constexpr int mantissa_bits = 52;
constexpr std::int64_t exponent_bias = 1023;

// ln 2 in two pieces: whole multiples of the first have no rounding error.
constexpr double ln2_high = 6.93147180369123816490e-01;
constexpr double ln2_low = 1.90821492927058770002e-10;

}  // namespace

double exponential(double x) noexcept {
  constexpr double furthest = 700.0;
  constexpr double log2_e = 1.44269504088896338700;
  x = std::clamp(x, -furthest, furthest);
  // x = k ln 2 + r, |r| <= ln 2 / 2.
  const double half = x < 0.0 ? -0.5 : 0.5;
  const auto k = static_cast<std::int64_t>(x * log2_e + half);
  const auto whole = static_cast<double>(k);
  const double r = (x - whole * ln2_high) - whole * ln2_low;
  // Taylor's series, by multiplications alone.
  constexpr std::array<double, 14> shares{1.0 / 14, 1.0 / 13, 1.0 / 12, 1.0 / 11, 1.0 / 10,
                                          1.0 / 9,  1.0 / 8,  1.0 / 7,  1.0 / 6,  1.0 / 5,
                                          1.0 / 4,  1.0 / 3,  1.0 / 2,  1.0};
  double sum = 1.0;
  for (const double share : shares) sum = 1.0 + r * share * sum;
  const auto power = static_cast<std::uint64_t>(k + exponent_bias) << mantissa_bits;
  return sum * std::bit_cast<double>(power);
}

double logarithm(double x) noexcept {
  // x = m 2^k, m about 1; ln m = 2 artanh((m - 1) / (m + 1)).
  constexpr double root_2 = 1.41421356237309514547;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  std::int64_t k = static_cast<std::int64_t>(bits >> mantissa_bits) - exponent_bias;
  constexpr std::uint64_t mantissa = (std::uint64_t{1} << mantissa_bits) - 1;
  double m = std::bit_cast<double>((bits & mantissa) |
                                   (static_cast<std::uint64_t>(exponent_bias) << mantissa_bits));
  if (m > root_2) {
    m /= 2.0;
    ++k;
  }
  const double s = (m - 1.0) / (m + 1.0);
  constexpr int highest = 21;
  double sum = 0.0;
  for (int n = highest; n > 0; n -= 2) sum = 1.0 / n + s * s * sum;
  const auto whole = static_cast<double>(k);
  return whole * ln2_high + (2.0 * s * sum + whole * ln2_low);
}

}  // namespace seqloop
