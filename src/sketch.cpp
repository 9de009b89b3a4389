// SPDX-License-Identifier: MIT
#include "seqloop/detail/sketch.hpp"

namespace seqloop {
namespace {

constexpr std::size_t bits_per_word = 64;

/// The n-th of a row of random numbers: SplitMix64, which needs no number before.
std::uint64_t random_number(std::uint64_t n) noexcept {
  std::uint64_t z = (n + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

}  // namespace

void choose_sketched_values(std::size_t descriptor_size, std::span<SketchedValue> out) noexcept {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint64_t random = random_number(i);
    const std::uint64_t place = ((random >> 32U) * descriptor_size) >> 32U;
    out[i] = {static_cast<std::uint32_t>(place) & 0x7FFFFFFFU, (random & 1U) != 0 ? 0U : 1U};
  }
}

void sketch(std::span<const std::int8_t> descriptor, std::span<const SketchedValue> chosen,
            std::span<std::uint64_t> out) noexcept {
  const SketchedValue* value = chosen.data();
  for (std::uint64_t& word : out) {
    word = 0;
    for (std::size_t bit = 0; bit < bits_per_word; ++bit) {
      std::int32_t sum = 0;
      for (std::size_t i = 0; i < values_per_bit; ++i, ++value) {
        const std::int32_t sign = 1 - 2 * static_cast<std::int32_t>(value->subtracted);
        sum += sign * descriptor[value->place];
      }
      word |= static_cast<std::uint64_t>(sum > 0) << bit;
    }
  }
}

}  // namespace seqloop
