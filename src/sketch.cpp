// SPDX-License-Identifier: MIT
#include "seqloop/detail/sketch.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace seqloop {
namespace {

constexpr std::size_t bits_per_word = 64;

// Bits that are gathered before they go to their word: as wide as the sums, which lie side by side.
constexpr std::size_t bits_together = 16;

/// The n-th of a row of random numbers: SplitMix64, which needs no number before.
std::uint64_t random_number(std::uint64_t n) noexcept {
  std::uint64_t z = (n + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

// Values of one descriptor, in a register where the processor has such.
using Values [[gnu::vector_size(sketched_together)]] = std::int8_t;

/// As many values of each descriptor as there are descriptors.
struct Tile {
  Values rows[sketched_together];
};

/// Writes a value of a row in the first half, then one of the row as far on in the second, and so
/// on. Four times, and rows have become columns.
void alternate(const Tile& from, Tile& to) noexcept {
  constexpr std::size_t half = sketched_together / 2;
  for (std::size_t i = 0; i < half; ++i) {
    const Values one = from.rows[i];
    const Values other = from.rows[i + half];
    to.rows[2 * i] =
        __builtin_shufflevector(one, other, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    to.rows[2 * i + 1] = __builtin_shufflevector(one, other, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28,
                                                 13, 29, 14, 30, 15, 31);
  }
}

/// @param both [2 D, abreast] descriptors side by side, and their negatives
template <std::size_t abreast>
void sketches_of(const std::int8_t* both, const SketchedValue* chosen, std::size_t words,
                 std::uint64_t* const* out) noexcept {
  const SketchedValue* end = chosen;
  for (std::size_t word = 0; word < words; ++word) {
    std::array<std::uint64_t, abreast> whole{};
    for (std::size_t part = 0; part < bits_per_word; part += bits_together) {
      end += bits_together * values_per_bit;
      // The highest bit first: each one moves those that are there on.
      const SketchedValue* value = end;
      std::array<std::uint16_t, abreast> bits{};
      for (std::size_t bit = 0; bit < bits_together; ++bit) {
        value -= values_per_bit;
        for (std::size_t i = 0; i < abreast; ++i) {
          std::int16_t sum = 0;
          for (std::size_t v = 0; v < values_per_bit; ++v) {
            sum = static_cast<std::int16_t>(sum + both[value[v] * abreast + i]);
          }
          bits[i] = static_cast<std::uint16_t>(bits[i] + bits[i] + (sum > 0 ? 1 : 0));
        }
      }
      for (std::size_t i = 0; i < abreast; ++i) whole[i] |= std::uint64_t{bits[i]} << part;
    }
    for (std::size_t i = 0; i < abreast; ++i) out[i][word] = whole[i];
  }
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
  std::uint64_t* const alone = out.data();
  sketches_of<1>(both.data(), chosen.data(), out.size(), &alone);
}

void side_by_side(std::span<const std::int8_t* const, sketched_together> descriptors,
                  std::size_t descriptor_size, std::span<std::int8_t> out) noexcept {
  std::int8_t* plain = out.data();
  std::int8_t* negative = plain + sketched_together * descriptor_size;
  const auto put = [&](const Values& values) {
    const Values negated = -values;
    std::memcpy(plain, &values, sketched_together);
    std::memcpy(negative, &negated, sketched_together);
    plain += sketched_together;
    negative += sketched_together;
  };
  std::size_t value = 0;
  for (; value + sketched_together <= descriptor_size; value += sketched_together) {
    Tile tile;
    for (std::size_t i = 0; i < sketched_together; ++i) {
      std::memcpy(&tile.rows[i], descriptors[i] + value, sketched_together);
    }
    Tile other;
    alternate(tile, other);
    alternate(other, tile);
    alternate(tile, other);
    alternate(other, tile);
    for (const Values& values : tile.rows) put(values);
  }
  for (; value < descriptor_size; ++value) {
    Values values;
    for (std::size_t i = 0; i < sketched_together; ++i) values[i] = descriptors[i][value];
    put(values);
  }
}

void sketch_together(const std::int8_t* both, const SketchedValue* chosen, std::size_t words,
                     std::uint64_t* const* out) noexcept {
  sketches_of<sketched_together>(both, chosen, words, out);
}

}  // namespace seqloop
