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

// What is turned over at once: 16 values of 16 descriptors.
constexpr std::size_t tile_size = 16;

// Values of one descriptor, in a register where the processor has such.
using Values [[gnu::vector_size(tile_size)]] = std::uint8_t;

/// As many values of each descriptor as there are descriptors.
struct Tile {
  Values rows[tile_size];
};

/// Writes a value of a row in the first half, then one of the row as far on in the second, and so
/// on. Four times, and rows have become columns.
void alternate(const Tile& from, Tile& to) noexcept {
  constexpr std::size_t half = tile_size / 2;
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
void sketches_of(const std::uint8_t* both, const SketchedValue* chosen, std::size_t words,
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
          std::uint16_t sum = 0;
          for (std::size_t v = 0; v < values_per_bit; ++v) {
            sum = static_cast<std::uint16_t>(sum + both[value[v] * abreast + i]);
          }
          const bool above = sum > values_per_bit * raised_by;
          bits[i] = static_cast<std::uint16_t>(bits[i] + bits[i] + (above ? 1 : 0));
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

void with_negative(std::span<const std::int8_t> descriptor, std::span<std::uint8_t> out) noexcept {
  std::ranges::transform(descriptor, out.begin(), [](std::int8_t value) {
    return static_cast<std::uint8_t>(raised_by + value);
  });
  std::ranges::transform(descriptor, out.subspan(descriptor.size()).begin(), [](std::int8_t value) {
    return static_cast<std::uint8_t>(raised_by - value);
  });
}

void sketch(std::span<const std::uint8_t> both, std::span<const SketchedValue> chosen,
            std::span<std::uint64_t> out) noexcept {
  std::uint64_t* const alone = out.data();
  sketches_of<1>(both.data(), chosen.data(), out.size(), &alone);
}

void side_by_side(std::span<const std::int8_t* const, sketched_together> descriptors,
                  std::size_t descriptor_size, std::span<std::uint8_t> out) noexcept {
  const auto put = [&](const Values& values, std::size_t value, std::size_t first) {
    const Values plain = values + raised_by;
    const Values negative = raised_by - values;
    std::uint8_t* const to = &out[value * sketched_together + first];
    std::memcpy(to, &plain, tile_size);
    std::memcpy(to + sketched_together * descriptor_size, &negative, tile_size);
  };
  std::size_t value = 0;
  for (; value + tile_size <= descriptor_size; value += tile_size) {
    for (std::size_t first = 0; first < sketched_together; first += tile_size) {
      Tile tile;
      for (std::size_t i = 0; i < tile_size; ++i) {
        std::memcpy(&tile.rows[i], descriptors[first + i] + value, tile_size);
      }
      Tile other;
      alternate(tile, other);
      alternate(other, tile);
      alternate(tile, other);
      alternate(other, tile);
      for (std::size_t i = 0; i < tile_size; ++i) put(tile.rows[i], value + i, first);
    }
  }
  for (; value < descriptor_size; ++value) {
    for (std::size_t first = 0; first < sketched_together; first += tile_size) {
      Values values;
      for (std::size_t i = 0; i < tile_size; ++i) {
        values[i] = static_cast<std::uint8_t>(descriptors[first + i][value]);
      }
      put(values, value, first);
    }
  }
}

void sketch_together(const std::uint8_t* both, const SketchedValue* chosen, std::size_t words,
                     std::uint64_t* const* out) noexcept {
  sketches_of<sketched_together>(both, chosen, words, out);
}

}  // namespace seqloop
