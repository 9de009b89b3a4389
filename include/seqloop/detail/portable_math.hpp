// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace seqloop {

/// What numbers and their powers are made of.
namespace portable {

inline constexpr int mantissa_bits = 52;
inline constexpr std::int64_t exponent_bias = 1023;

// ln 2 in two pieces: whole multiples of the first have no rounding error.
inline constexpr double ln2_high = 6.93147180369123816490e-01;
inline constexpr double ln2_low = 1.90821492927058770002e-10;

// 2^(i / 32), each to the nearest double.
inline constexpr std::array<double, 32> roots_of_2{1.0,
                                                   1.0218971486541166,
                                                   1.0442737824274138,
                                                   1.0671404006768237,
                                                   1.0905077326652577,
                                                   1.1143867425958924,
                                                   1.1387886347566916,
                                                   1.1637248587775775,
                                                   1.189207115002721,
                                                   1.215247359980469,
                                                   1.241857812073484,
                                                   1.2690509571917332,
                                                   1.2968395546510096,
                                                   1.3252366431597413,
                                                   1.3542555469368927,
                                                   1.383909881963832,
                                                   1.4142135623730951,
                                                   1.4451808069770467,
                                                   1.4768261459394993,
                                                   1.5091644275934228,
                                                   1.5422108254079407,
                                                   1.5759808451078865,
                                                   1.6104903319492543,
                                                   1.645755478153965,
                                                   1.681792830507429,
                                                   1.718619298122478,
                                                   1.7562521603732995,
                                                   1.7947090750031072,
                                                   1.8340080864093424,
                                                   1.8741676341103,
                                                   1.9152065613971474,
                                                   1.9571441241754002};

}  // namespace portable

/// e^x to about 1e-15 of it, by operations that IEEE 754 defines to the last bit, in one order: the
/// same on every processor, which the C library's is not. Inline: a step asks for hundreds of them.
/// @param x finite, taken into -700 .. 700
[[nodiscard]] inline double exponential(double x) noexcept {
  using namespace portable;
  constexpr double furthest = 700.0;
  constexpr double log2_e = 1.44269504088896338700;
  x = std::min(std::max(x, -furthest), furthest);
  // x = (k + i / 32) ln 2 + r, |r| <= ln 2 / 64.
  constexpr auto pieces = static_cast<std::int64_t>(roots_of_2.size());
  const auto n = static_cast<std::int64_t>(x * (log2_e * pieces) + std::copysign(0.5, x));
  const std::int64_t k = n >> 5U;
  const double root = roots_of_2[static_cast<std::size_t>(n & (pieces - 1))];
  const auto whole = static_cast<double>(n);
  const double r = (x - whole * (ln2_high / pieces)) - whole * (ln2_low / pieces);
  const double sum =
      1.0 + r * (1.0 + r * (1.0 / 2 + r * (1.0 / 6 + r * (1.0 / 24 + r * (1.0 / 120)))));
  const auto power = static_cast<std::uint64_t>(k + exponent_bias) << mantissa_bits;
  return root * sum * std::bit_cast<double>(power);
}

/// The natural logarithm, in the same way. @param x normal, above 0
[[nodiscard]] double logarithm(double x) noexcept;

/// 1 / (1 + e^-x): what a log-odds is as a probability.
[[nodiscard]] inline double logistic(double x) noexcept { return 1.0 / (1.0 + exponential(-x)); }

}  // namespace seqloop
