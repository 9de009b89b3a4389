// SPDX-License-Identifier: MIT
// Descriptors of one byte a value, and how far they lie apart.
#include "seqloop/detail/quantised.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "seqloop/detail/fixed_distance.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

using Bytes = std::vector<std::int8_t>;

Bytes quantised(const std::vector<float>& descriptor) {
  Bytes bytes(descriptor.size());
  quantise(descriptor, bytes);
  return bytes;
}

/// A descriptor, its bytes and what is known of them.
struct Small {
  explicit Small(std::vector<float> unit) : descriptor(std::move(unit)) {
    descriptor.resize(padded_size(descriptor.size()), 0.0F);
    bytes.resize(descriptor.size());
    known = quantise(descriptor, bytes);
  }
  [[nodiscard]] double inverse() const { return inverse_length(known.squared_norm); }

  std::vector<float> descriptor;
  Bytes bytes;
  Quantised known{};
};

std::int32_t dot(const Small& a, const Small& b) {
  return best_integer_kernels().dot(a.bytes.data(), b.bytes.data(), a.bytes.size());
}

std::uint16_t apart(const Small& a, const Small& b) {
  return fixed_distance(dot(a, b), a.inverse(), b.inverse());
}

std::vector<float> random_unit(std::mt19937& random, std::size_t size) {
  std::normal_distribution<float> normal;
  std::vector<float> vector(size);
  for (float& value : vector) value = normal(random);
  normalise(vector);
  return vector;
}

TEST(Quantise, RoundsToTheNearestAndHalvesToTheEvenOne) {
  const std::vector<float> halves{127.0F, 0.5F, 1.5F, 2.5F, -0.5F, -1.5F, -2.5F, 126.5F, -126.5F};
  EXPECT_EQ(quantised(halves), (Bytes{127, 0, 2, 2, 0, -2, -2, 126, -126}));
  const std::vector<float> beside{127.0F, 0.49999997F, 0.50000006F, 1.4999999F, -0.50000006F};
  EXPECT_EQ(quantised(beside), (Bytes{127, 0, 1, 1, -1}));
}

TEST(Quantise, MakesTheLargestValue127WhateverItsSizeAndSign) {
  for (const float largest : {1.0F, 0.3F, 1e-30F, 1e30F, std::numeric_limits<float>::max(),
                              std::numeric_limits<float>::denorm_min()}) {
    EXPECT_EQ(quantised({largest, -largest, 0.0F, -0.0F}), (Bytes{127, -127, 0, 0})) << largest;
  }
}

TEST(Quantise, KeepsTheSquaredNormAndZerosThePadding) {
  const std::vector<float> descriptor{0.6F, 0.0F, -0.8F};
  Bytes bytes(64, 99);
  const Quantised known = quantise(descriptor, bytes);
  EXPECT_EQ(bytes[0], 95);
  EXPECT_EQ(bytes[2], -127);
  EXPECT_EQ(known.squared_norm, 95 * 95 + 127 * 127);
  EXPECT_FLOAT_EQ(known.scale, 0.8F / 127.0F);
  for (std::size_t i = 3; i < bytes.size(); ++i) EXPECT_EQ(bytes[i], 0) << i;
}

TEST(Quantise, HasAZeroVector) {
  Bytes bytes(64, 99);
  const Quantised known = quantise(std::vector<float>(5, 0.0F), bytes);
  EXPECT_EQ(known.squared_norm, 0);
  EXPECT_EQ(known.scale, 0.0F);
  EXPECT_EQ(bytes, Bytes(64, 0));
  EXPECT_EQ(inverse_length(0), 0.0);
  EXPECT_EQ(quantise(std::span<const float>(), bytes).squared_norm, 0);
}

TEST(Quantise, HoldsTheLongestDescriptor) {
  const std::vector<float> flat(most_small_values, -0.002F);
  Bytes bytes(flat.size());
  EXPECT_EQ(quantise(flat, bytes).squared_norm, 127 * 127 * std::int32_t{most_small_values});
}

TEST(Quantise, IsTheSameOnEveryProcessor) {
  // A synthetic descriptor without the C++ library's random numbers; its bytes are written down as
  // FNV-1a.
  std::vector<float> descriptor(1000);
  std::uint32_t state = 1;
  for (float& value : descriptor) {
    state = state * 1664525U + 1013904223U;
    value = static_cast<float>(static_cast<std::int32_t>(state)) / 4294967296.0F;
  }
  std::uint64_t hash = 14695981039346656037U;
  for (const std::int8_t value : quantised(descriptor)) {
    hash = (hash ^ static_cast<std::uint8_t>(value)) * 1099511628211U;
  }
  EXPECT_EQ(hash, 13961414736402213606U);
}

TEST(FixedDistance, IsWithinItsBoundOfTheEuclideanDistance) {
  std::mt19937 random(21);
  for (const std::size_t size : {1U, 2U, 3U, 16U, 735U, 9216U}) {
    for (int pair = 0; pair < 50; ++pair) {
      const std::vector<float> first = random_unit(random, size);
      std::vector<float> second = random_unit(random, size);
      // From nearly equal to opposite.
      const float share = static_cast<float>(pair) / 25.0F - 1.0F;
      for (std::size_t i = 0; i < size; ++i) second[i] = second[i] * 0.1F + share * first[i];
      normalise(second);
      const Small a(first);
      const Small b(second);
      const double exact = static_cast<double>(euclidean(a.descriptor, b.descriptor));
      const double fixed = apart(a, b) / static_cast<double>(fixed_distance_one);
      const double bound = std::sqrt(static_cast<double>(size) / 2.0) *
                               static_cast<double>(a.known.scale + b.known.scale) +
                           1.0 / 65534.0 + 1e-7;
      EXPECT_NEAR(fixed, exact, bound) << size << ' ' << pair;
    }
  }
}

TEST(FixedDistance, IsZeroBetweenEqualOnesAndTheSameBothWays) {
  std::mt19937 random(22);
  for (int pair = 0; pair < 1000; ++pair) {
    const Small a(random_unit(random, 33));
    const Small b(random_unit(random, 33));
    EXPECT_EQ(apart(a, a), 0);
    EXPECT_EQ(apart(a, b), apart(b, a));
  }
}

TEST(FixedDistance, KnowsOppositeRightAngledAndZeroVectors) {
  const Small east({1.0F, 0.0F});
  const Small west({-1.0F, 0.0F});
  const Small north({0.0F, 1.0F});
  const Small nowhere({0.0F, 0.0F});
  EXPECT_EQ(apart(east, west), 2 * fixed_distance_one);
  EXPECT_LT(apart(east, west), no_fixed_distance);
  EXPECT_EQ(apart(east, north), 46340) << "sqrt(2)";
  EXPECT_EQ(apart(east, nowhere), fixed_distance_one);
  EXPECT_EQ(apart(nowhere, east), fixed_distance_one);
  EXPECT_EQ(apart(nowhere, nowhere), 0);
  EXPECT_EQ(euclidean(east.descriptor, nowhere.descriptor), 1.0F) << "as the float one";
}

TEST(FixedDistance, NeverGrowsWithTheDot) {
  const double inverse_a = inverse_length(5'000'000);
  const double inverse_b = inverse_length(4'000'003);
  std::uint16_t before = no_fixed_distance;
  for (std::int32_t dot = -4'472'000; dot <= 4'472'000; dot += 37) {
    const std::uint16_t now = fixed_distance(dot, inverse_a, inverse_b);
    ASSERT_LE(now, before) << dot;
    before = now;
  }
  EXPECT_LT(before, 500);
}

TEST(FixedDistance, SumsOfTheLongestSequencesFit32Bits) {
  constexpr std::uint64_t longest = 10'000;
  static_assert((longest + 1) * no_fixed_distance <= std::numeric_limits<std::int32_t>::max());
}

TEST(FixedDistances, AreTheSingleOnesForEveryCount) {
  std::mt19937 random(23);
  std::uniform_int_distribution<std::int32_t> dots_of(-1'000'000, 1'000'000);
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<std::int32_t> dots(count);
    std::vector<double> inverses(count);
    for (std::size_t row = 0; row < count; ++row) {
      dots[row] = dots_of(random);
      inverses[row] = row % 7 == 3 ? 0.0 : inverse_length(1'000'000 + static_cast<int>(row));
      if (row % 7 == 3) dots[row] = 0;
    }
    for (const double inverse_query : {0.0, inverse_length(1'000'001)}) {
      std::vector<std::uint16_t> out(count + 1, 77);
      fixed_distances(dots, inverse_query, inverses, std::span(out).first(count));
      for (std::size_t row = 0; row < count; ++row) {
        const std::int32_t dot = dots[row];
        EXPECT_EQ(out[row], fixed_distance(dot, inverse_query, inverses[row])) << row;
      }
      EXPECT_EQ(out[count], 77);
    }
  }
}

}  // namespace
}  // namespace seqloop
