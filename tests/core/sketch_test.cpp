// SPDX-License-Identifier: MIT
#include "seqloop/detail/sketch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "guarded_bytes.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/detail/quantised.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

using Bytes = std::vector<std::int8_t>;
using Words = std::vector<std::uint64_t>;

Words sketched(std::span<const std::int8_t> descriptor, std::size_t words = sketch_words) {
  Words out(words, ~std::uint64_t{0});
  std::vector<SketchedValue> chosen(sketched_values(words));
  choose_sketched_values(descriptor.size(), chosen);
  std::vector<std::uint8_t> both(2 * descriptor.size());
  with_negative(descriptor, both);
  sketch(both, chosen, out);
  return out;
}

std::uint32_t bits_apart(const Words& a, const Words& b) {
  return best_integer_kernels().hamming(a.data(), b.data(), a.size());
}

Bytes quantised(const std::vector<float>& descriptor) {
  Bytes bytes(descriptor.size());
  quantise(descriptor, bytes);
  return bytes;
}

TEST(Sketch, DiffersByTheAngle) {
  std::mt19937 random(31);
  std::normal_distribution<float> normal;
  for (const std::size_t size : {735U, 9216U}) {
    std::vector<float> one(size);
    std::vector<float> other(size);
    for (std::size_t i = 0; i < size; ++i) {
      one[i] = normal(random);
      other[i] = normal(random);
    }
    for (int step = 0; step <= 8; ++step) {
      const double angle = std::numbers::pi * step / 8.0;
      std::vector<float> turned(size);
      for (std::size_t i = 0; i < size; ++i) {
        turned[i] = static_cast<float>(std::cos(angle)) * one[i] +
                    static_cast<float>(std::sin(angle)) * other[i];
      }
      const double bits = bits_apart(sketched(quantised(one)), sketched(quantised(turned)));
      // The deviation of 2,048 independent bits is at most 23.
      EXPECT_NEAR(bits, 2048.0 * step / 8.0, 120.0) << size << ' ' << step;
    }
  }
}

TEST(Sketch, OfAZeroVectorIsZero) { EXPECT_EQ(sketched(Bytes(100, 0)), Words(sketch_words, 0)); }

TEST(Sketch, OfAShortDescriptorReadsNothingElse) {
  for (const std::size_t size : {1U, 2U, 63U, 735U}) {
    test::GuardedBytes memory(size);
    const std::vector<std::uint8_t> values(size, 3);
    const std::span<const std::uint8_t> held = memory.hold(values);
    const Words bits = sketched({reinterpret_cast<const std::int8_t*>(held.data()), size});
    EXPECT_EQ(bits, sketched(Bytes(size, 3)));
  }
}

TEST(Sketch, BeginsWithTheShorterOne) {
  std::mt19937 random(32);
  Bytes descriptor(500);
  for (std::int8_t& value : descriptor) value = static_cast<std::int8_t>(random() % 255U - 127U);
  const Words shorter = sketched(descriptor, 3);
  const Words longer = sketched(descriptor, 40);
  EXPECT_TRUE(std::ranges::equal(shorter, std::span(longer).first(3)));
  EXPECT_TRUE(sketched(descriptor, 0).empty());
}

TEST(Sketch, OfManyTogetherIsThatOfEach) {
  std::mt19937 random(33);
  for (const std::size_t size : {1U, 2U, 31U, 128U, 735U}) {
    for (const std::size_t words : {1U, 16U, 32U}) {
      std::vector<Bytes> descriptors(sketched_together, Bytes(size));
      std::array<const std::int8_t*, sketched_together> rows{};
      std::vector<Words> sketches(sketched_together, Words(words));
      std::array<std::uint64_t*, sketched_together> out{};
      for (std::size_t i = 0; i < sketched_together; ++i) {
        // Sums of small values are often 0 and beside it; the largest two fill a byte.
        const unsigned largest = i % 4 == 0 ? 1 : 127;
        const unsigned step = i % 4 == 1 ? 2 * largest : 1;
        for (std::int8_t& value : descriptors[i]) {
          value = static_cast<std::int8_t>(random() % (2 * largest / step + 1) * step - largest);
        }
        rows[i] = descriptors[i].data();
        out[i] = sketches[i].data();
      }
      std::vector<SketchedValue> chosen(sketched_values(words));
      choose_sketched_values(size, chosen);
      std::vector<std::uint8_t> both(static_cast<std::size_t>(side_by_side_values(size)));
      side_by_side(rows, size, both);
      for (const IntegerKernels* kernels : integer_kernels()) {
        if (!kernels->supported()) continue;
        for (Words& sketch : sketches) std::ranges::fill(sketch, 0);
        kernels->sketch_together(both.data(), chosen.data(), words, out.data());
        for (std::size_t i = 0; i < sketched_together; ++i) {
          EXPECT_EQ(sketches[i], sketched(descriptors[i], words))
              << kernels->name << ' ' << size << ' ' << words << ' ' << i;
        }
      }
    }
  }
}

TEST(Sketch, IsTheSameOnEveryProcessor) {
  Bytes descriptor(735);
  std::uint32_t state = 1;
  for (std::int8_t& value : descriptor) {
    state = state * 1664525U + 1013904223U;
    value = static_cast<std::int8_t>(static_cast<std::int32_t>((state >> 24U) % 255U) - 127);
  }
  std::uint64_t hash = 14695981039346656037U;
  for (const std::uint64_t word : sketched(descriptor)) {
    hash = (hash ^ word) * 1099511628211U;
  }
  EXPECT_EQ(hash, 7575556150526507990U);
}

}  // namespace
}  // namespace seqloop
