#include "seqloop/sketch.hpp"

#include <algorithm>
#include <array>

namespace seqloop {
namespace {

static_assert(values_per_bit == 4, "what one random number decides");

// Eight bits are made side by side in one 64-bit word, which every processor computes with.
constexpr std::size_t run = 8;
constexpr std::size_t runs_per_word = 64 / run;
constexpr std::uint64_t every_byte = 0x0101010101010101U;
constexpr std::uint64_t every_second = 0x0001000100010001U;

/// The n-th of a row of random numbers: SplitMix64, which needs no number before.
std::uint64_t random_number(std::uint64_t n) noexcept {
  std::uint64_t z = (n + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

/// A descriptor as a ring: behind the last value comes the first one.
class Ring {
 public:
  explicit Ring(std::span<const std::int8_t> values) noexcept
      : values_(values), beyond_(values.size() - std::min(values.size(), run - 1)) {
    for (std::size_t i = 0; i < seam_.size(); ++i) seam_[i] = values[(beyond_ + i) % values.size()];
  }

  /// The run that a random number chooses, each value larger by 128, the first in the lowest byte.
  [[nodiscard]] std::uint64_t shifted_run(std::uint32_t random) const noexcept {
    const auto place = static_cast<std::size_t>((std::uint64_t{random} * values_.size()) >> 32U);
    const std::int8_t* from =
        place < beyond_ ? values_.data() + place : seam_.data() + (place - beyond_);
    std::uint64_t bytes = 0;
    for (std::size_t i = 0; i < run; ++i) {
      bytes |= std::uint64_t{static_cast<std::uint8_t>(from[i])} << (i * 8);
    }
    return bytes ^ (every_byte * 128);
  }

 private:
  std::span<const std::int8_t> values_;
  std::size_t beyond_;  // the first place where a run would leave the values
  std::array<std::int8_t, 2 * (run - 1)> seam_{};
};

/// Sums of bytes: those at even places and those at odd ones, 16 bits each.
struct ByteSums {
  std::uint64_t even = 0;
  std::uint64_t odd = 0;

  void add(std::uint64_t bytes) noexcept {
    even += bytes & (every_second * 255);
    odd += (bytes >> 8U) & (every_second * 255);
  }

  /// In the lowest bit of every byte, whether its sum is above `limit`, from 0 up to 2^15.
  [[nodiscard]] std::uint64_t above(std::uint64_t limit) const noexcept {
    const std::uint64_t to_the_top_bit = every_second * ((std::uint64_t{1} << 15U) - 1 - limit);
    const std::uint64_t even_above = ((even + to_the_top_bit) >> 15U) & every_second;
    const std::uint64_t odd_above = ((odd + to_the_top_bit) >> 15U) & every_second;
    return even_above | (odd_above << 8U);
  }
};

/// Eight bits, one in every byte.
std::uint64_t sketched_run(const Ring& ring, std::uint64_t number) noexcept {
  const std::uint64_t signs = random_number(3 * number);
  const std::array places{random_number(3 * number + 1), random_number(3 * number + 2)};
  ByteSums sums;
  for (std::size_t i = 0; i < values_per_bit; ++i) {
    const std::uint64_t values =
        ring.shifted_run(static_cast<std::uint32_t>(places[i / 2] >> (i % 2 * 32)));
    // 128 - v is the inverse of 128 + v, plus 1.
    const std::uint64_t subtracted = (signs >> i) & every_byte;
    sums.add(values ^ (subtracted * 255));
    sums.add(subtracted);
  }
  return sums.above(values_per_bit * 128);
}

}  // namespace

void sketch(std::span<const std::int8_t> descriptor, std::span<std::uint64_t> out) noexcept {
  const Ring ring(descriptor);
  for (std::size_t word = 0; word < out.size(); ++word) {
    out[word] = 0;
    for (std::size_t i = 0; i < runs_per_word; ++i) {
      out[word] |= sketched_run(ring, word * runs_per_word + i) << i;
    }
  }
}

}  // namespace seqloop
