// SPDX-License-Identifier: MIT
#include "seqloop/detail/quantised.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>

namespace seqloop {
namespace {

static_assert(FLT_EVAL_METHOD == 0, "every operation has to round as IEEE 754 says");

constexpr double largest = 127.0;

/// To the nearest integer, halves to the even one, for values whose integer fits a byte: what is
/// added leaves no room for a fraction, so that the lowest byte is the integer's.
std::int8_t rounded(double x) noexcept {
  constexpr double no_fraction = 6755399441055744.0;  // 1.5 * 2^52
  return static_cast<std::int8_t>(std::bit_cast<std::int64_t>(x + no_fraction));
}

/// The largest of all without their signs. In lanes, because the next comparison of one would have
/// to wait for the last.
float highest_of(std::span<const float> values) noexcept {
  constexpr std::size_t lanes = 16;
  std::array<float, lanes> highest{};
  const auto take = [&](std::size_t lane, float value) {
    const float size = std::abs(value);
    highest[lane] = size > highest[lane] ? size : highest[lane];
  };
  const std::size_t whole = values.size() / lanes * lanes;
  for (std::size_t i = 0; i < whole; i += lanes) {
    for (std::size_t lane = 0; lane < lanes; ++lane) take(lane, values[i + lane]);
  }
  for (std::size_t i = whole; i < values.size(); ++i) take(i - whole, values[i]);
  return *std::ranges::max_element(highest);
}

}  // namespace

Quantised quantise(std::span<const float> descriptor, std::span<std::int8_t> out) noexcept {
  const float highest = highest_of(descriptor);
  std::ranges::fill(out.subspan(descriptor.size()), std::int8_t{0});
  if (highest == 0.0F) {
    std::ranges::fill(out, std::int8_t{0});
    return {0.0F, 0};
  }
  const double factor = largest / static_cast<double>(highest);
  for (std::size_t i = 0; i < descriptor.size(); ++i) {
    out[i] = rounded(static_cast<double>(descriptor[i]) * factor);
  }
  std::int32_t squares = 0;
  for (const std::int8_t byte : out.first(descriptor.size())) {
    // Of 16 bits, because processors multiply and add these in one go. A number, no character:
    const std::int16_t value = byte;  // NOLINT(bugprone-signed-char-misuse,cert-str34-c)
    squares += value * value;
  }
  return {static_cast<float>(static_cast<double>(highest) / largest), squares};
}

double inverse_length(std::int32_t squared_norm) noexcept {
  return squared_norm == 0 ? 0.0 : 1.0 / std::sqrt(static_cast<double>(squared_norm));
}

}  // namespace seqloop
