#include "seqloop/quantised.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace seqloop {
namespace {

static_assert(FLT_EVAL_METHOD == 0, "every operation has to round as IEEE 754 says");

constexpr double largest = 127.0;

/// To the nearest integer, halves to the even one, for |x| below 2^51: what is added leaves no room
/// for a fraction.
double rounded(double x) noexcept {
  constexpr double no_fraction = 6755399441055744.0;  // 1.5 * 2^52
  return (x + no_fraction) - no_fraction;
}

}  // namespace

Quantised quantise(std::span<const float> descriptor, std::span<std::int8_t> out) noexcept {
  float highest = 0.0F;
  for (const float value : descriptor) highest = std::max(highest, std::abs(value));
  std::ranges::fill(out.subspan(descriptor.size()), std::int8_t{0});
  if (highest == 0.0F) {
    std::ranges::fill(out, std::int8_t{0});
    return {0.0F, 0};
  }
  const double factor = largest / static_cast<double>(highest);
  std::int32_t squares = 0;
  for (std::size_t i = 0; i < descriptor.size(); ++i) {
    const auto value =
        static_cast<std::int32_t>(rounded(static_cast<double>(descriptor[i]) * factor));
    out[i] = static_cast<std::int8_t>(value);
    squares += value * value;
  }
  return {static_cast<float>(static_cast<double>(highest) / largest), squares};
}

double inverse_length(std::int32_t squared_norm) noexcept {
  return squared_norm == 0 ? 0.0 : 1.0 / std::sqrt(static_cast<double>(squared_norm));
}

}  // namespace seqloop
