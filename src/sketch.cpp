// SPDX-License-Identifier: MIT
#include "seqloop/detail/sketch.hpp"

#include <algorithm>

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
    const std::uint64_t subtracted = (random & 1U) != 0 ? 0 : descriptor_size;
    out[i] = static_cast<SketchedValue>(place + subtracted);
  }
}

void with_negative(std::span<const std::int8_t> descriptor, std::span<std::int8_t> out) noexcept {
  std::ranges::copy(descriptor, out.begin());
  std::ranges::transform(descriptor, out.subspan(descriptor.size()).begin(),
                         [](std::int8_t value) { return static_cast<std::int8_t>(-value); });
}

void sketch(std::span<const std::int8_t> both, std::span<const SketchedValue> chosen,
            std::span<std::uint64_t> out) noexcept {
  const SketchedValue* value = chosen.data();
  for (std::uint64_t& word : out) {
    std::uint64_t bits = 0;
    for (std::size_t bit = 0; bit < bits_per_word; ++bit) {
      std::int32_t sum = 0;
      for (std::size_t i = 0; i < values_per_bit; ++i) sum += both[*value++];
      bits |= static_cast<std::uint64_t>(sum > 0) << bit;
    }
    word = bits;
  }
}

}  // namespace seqloop
