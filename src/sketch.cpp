#include "seqloop/sketch.hpp"

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

/// The value that a random number chooses, or its negative.
std::int32_t chosen(std::span<const std::int8_t> descriptor, std::uint64_t random) noexcept {
  const auto place = static_cast<std::size_t>(((random >> 32U) * descriptor.size()) >> 32U);
  const std::int32_t sign = (random & 1U) != 0 ? 1 : -1;
  return sign * descriptor[place];
}

bool above(std::span<const std::int8_t> descriptor, std::uint64_t bit) noexcept {
  std::int32_t sum = 0;
  for (std::uint64_t i = 0; i < values_per_bit; ++i) {
    sum += chosen(descriptor, random_number(bit * values_per_bit + i));
  }
  return sum > 0;
}

}  // namespace

void sketch(std::span<const std::int8_t> descriptor, std::span<std::uint64_t> out) noexcept {
  for (std::size_t word = 0; word < out.size(); ++word) {
    out[word] = 0;
    for (std::size_t bit = 0; bit < bits_per_word; ++bit) {
      const bool set = above(descriptor, word * bits_per_word + bit);
      out[word] |= static_cast<std::uint64_t>(set) << bit;
    }
  }
}

}  // namespace seqloop
