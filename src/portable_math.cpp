// SPDX-License-Identifier: MIT
#include "seqloop/detail/portable_math.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace seqloop {
namespace {

constexpr std::array<double, 11> odd_reciprocals{1.0,      1.0 / 3,  1.0 / 5,  1.0 / 7,
                                                 1.0 / 9,  1.0 / 11, 1.0 / 13, 1.0 / 15,
                                                 1.0 / 17, 1.0 / 19, 1.0 / 21};

}  // namespace

double logarithm(double x) noexcept {
  using namespace portable;
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
  double sum = 0.0;
  for (std::size_t n = odd_reciprocals.size(); n-- > 0;) sum = odd_reciprocals[n] + s * s * sum;
  const auto whole = static_cast<double>(k);
  return whole * ln2_high + (2.0 * s * sum + whole * ln2_low);
}

}  // namespace seqloop
