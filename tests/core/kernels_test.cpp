// SPDX-License-Identifier: MIT
// Each kernel beside its definition.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/matcher.hpp"
#include "seqloop/detail/contrast.hpp"
#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

TEST(Euclidean, EqualsTheDefinitionForEveryLength) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  double furthest = 0.0;
  for (const std::size_t size : {16U, 32U, 48U, 512U, 528U, 9216U, 64896U}) {
    // From nearly equal to unlike.
    for (const float noise : {1e-4F, 1e-3F, 0.01F, 0.1F, 1.0F, 10.0F}) {
      std::vector<float> a(size);
      std::vector<float> b(size);
      for (std::size_t i = 0; i < size; ++i) {
        a[i] = normal(random);
        b[i] = a[i] + noise * normal(random);
      }
      normalise(a);
      normalise(b);
      double square = 0.0;
      for (std::size_t i = 0; i < size; ++i) {
        const double differ = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        square += differ * differ;
      }
      EXPECT_NEAR(euclidean(a, b), std::sqrt(square), 1e-7);
      const auto distance = static_cast<double>(euclidean(dot(a, a), dot(b, b), dot(a, b)));
      furthest = std::max(furthest, std::abs(distance * distance - square));
      EXPECT_EQ(euclidean(dot(a, a), dot(a, a), dot(a, a)), 0.0F)
          << "equal vectors must not differ by rounding";
    }
  }
  std::printf("squares of distances from dot products: %.1e off at most\n", furthest);
  EXPECT_LE(furthest, 5e-7);
  EXPECT_EQ(euclidean({}, {}), 0.0F);
}

TEST(Euclidean, OfTheWorstRoundingStaysWithinItsBound) {
  // All of one sign, and growing over the steps of a lane, so that nothing evens out.
  for (const std::size_t size : {512U, 9216U}) {
    std::vector<float> a(size, 1.0F);
    for (std::size_t i = 0; i < size; ++i) a[i] += 0.37F * static_cast<float>(i / dot_lanes % 64);
    normalise(a);
    double exact = 0.0;
    for (const float value : a) exact += static_cast<double>(value) * static_cast<double>(value);
    EXPECT_NEAR(dot(a, a), exact, 67.0 * std::ldexp(1.0, -24) * exact) << size;
  }
}

/// The order of additions as `dot` describes it, by the library's own fused multiply-add.
double dot_in_order(std::span<const float> a, std::span<const float> b) {
  double sum = 0.0;
  for (std::size_t first = 0; first < a.size(); first += 512) {
    std::array<float, 8> lane{};
    for (std::size_t i = first; i < std::min(first + 512, a.size()); ++i) {
      lane[i % 8] = std::fmaf(a[i], b[i], lane[i % 8]);
    }
    const float low = (lane[0] + lane[2]) + (lane[1] + lane[3]);
    const float high = (lane[4] + lane[6]) + (lane[5] + lane[7]);
    sum += static_cast<double>(low + high);
  }
  return sum;
}

/// Equal, or neither a number.
void expect_same(double dot, double expected, const std::string& what) {
  if (std::isnan(expected)) {
    ASSERT_TRUE(std::isnan(dot)) << what;
  } else {
    ASSERT_EQ(dot, expected) << what;
  }
}

TEST(FloatKernels, FuseAlsoWhereTheProcessorCannot) {
  std::mt19937 random(16);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  constexpr std::size_t size = 528;
  // Products below the smallest normal number, sums half way between two floats, sums beyond all;
  // and sums that come near zero, where terms take each other off.
  const std::vector<float> scales{1.0F, 1e-3F, 1e-19F, 3e-23F, 1e19F, 3e38F};
  const std::vector<float> steps{0.0F, 4096.0F, 8.0F};
  for (const float scale : scales) {
    for (const float step : steps) {
      for (int time = 0; time < 50; ++time) {
        std::vector<float> query(size);
        std::vector<float> rows(4 * size, 0.0F);
        const auto drawn = [&](float steps_of_one) {
          const float value = uniform(random);
          return scale *
                 (steps_of_one > 0.0F ? std::round(value * steps_of_one) / steps_of_one : value);
        };
        for (float& value : query) value = drawn(step);
        for (float& value : std::span(rows).first(2 * size)) value = drawn(8.0F);
        for (std::size_t i = 0; i < size; ++i) {
          rows[2 * size + i] = i / 8 % 2 == 0 ? query[i] : -query[i - 8];
        }
        for (const FloatKernels* kernels : float_kernels()) {
          if (!kernels->supported()) continue;
          std::array<double, 4> dots{};
          kernels->dots(query.data(), rows.data(), size, dots.size(), dots.data());
          for (std::size_t row = 0; row < dots.size(); ++row) {
            expect_same(dots[row], dot_in_order(query, std::span(rows).subspan(row * size, size)),
                        std::string(kernels->name) + ' ' + std::to_string(scale) + ' ' +
                            std::to_string(step) + ' ' + std::to_string(row));
          }
        }
      }
    }
  }
}

TEST(FloatKernels, AreTheSameBytesOnEveryProcessor) {
  std::mt19937 random(14);
  std::normal_distribution<float> normal;
  for (const FloatKernels* kernels : float_kernels()) {
    if (!kernels->supported()) continue;
    for (const std::size_t size : {0U, 16U, 48U, 736U, 1024U, 1040U, 9216U}) {
      for (const std::size_t count : {0U, 1U, 3U, 4U, 9U}) {
        std::vector<float> query(size);
        std::vector<float> rows(count * size);
        for (float& value : query) value = normal(random);
        for (float& value : rows) value = normal(random);
        std::vector<double> dots(count + 1, -1.0);
        kernels->dots(query.data(), rows.data(), size, count, dots.data());
        for (std::size_t row = 0; row < count; ++row) {
          EXPECT_EQ(dots[row], dot(query, std::span(rows).subspan(row * size, size)))
              << kernels->name << ' ' << size << ' ' << row;
        }
        EXPECT_EQ(dots[count], -1.0) << "nothing behind the last";
      }
    }
  }
}

TEST(FloatKernels, OfSeveralAreThoseOfEach) {
  std::mt19937 random(15);
  std::normal_distribution<float> normal;
  // With products below the smallest normal number, and sums beyond the largest.
  const auto compare = [&](std::size_t size, std::size_t queries, std::size_t count, float scale) {
    std::vector<float> query(queries * size);
    std::vector<float> rows(count * size);
    for (float& value : query) value = scale * normal(random);
    for (float& value : rows) value = scale * normal(random);
    const std::size_t stride = count + 2;
    for (const FloatKernels* kernels : float_kernels()) {
      if (!kernels->supported()) continue;
      std::vector<double> dots(queries * stride, -1.0);
      kernels->dots_block(query.data(), queries, rows.data(), size, count, dots.data(), stride);
      for (std::size_t q = 0; q < queries; ++q) {
        for (std::size_t row = 0; row < count; ++row) {
          expect_same(dots[q * stride + row],
                      dot(std::span(query).subspan(q * size, size),
                          std::span(rows).subspan(row * size, size)),
                      std::string(kernels->name) + ' ' + std::to_string(size) + ' ' +
                          std::to_string(q) + ' ' + std::to_string(row) + ' ' +
                          std::to_string(scale));
        }
        EXPECT_EQ(dots[q * stride + count], -1.0) << "nothing behind the last";
      }
    }
  };
  for (const std::size_t size : {0U, 16U, 512U, 736U, 2064U}) {
    for (const std::size_t queries : {0U, 1U, 2U, 3U, 4U, 7U, 11U}) {
      for (const std::size_t count : {0U, 1U, 4U, 11U, 16U, 33U}) {
        compare(size, queries, count, 1.0F);
      }
    }
    for (const float scale : {1e-19F, 3e-23F, 1e19F, 1e37F}) compare(size, 11, 33, scale);
  }
  compare(1040, MatcherConfig::most_frames_at_once, 96, 1.0F);
}

TEST(MeanAbsolute, EqualsTheDefinitionWithoutThePadding) {
  std::mt19937 random(12);
  std::normal_distribution<float> normal;
  for (const std::size_t size : {1U, 15U, 16U, 17U, 1024U, 1025U, 2048U}) {
    std::vector<float> a(padded_size(size), 0.0F);
    std::vector<float> b(padded_size(size), 0.0F);
    double sum = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      a[i] = normal(random);
      b[i] = normal(random);
      sum += std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    }
    EXPECT_NEAR(mean_absolute(a, b, size), sum / static_cast<double>(size), 1e-5) << size;
    EXPECT_EQ(mean_absolute(a, a, size), 0.0F);
  }
}

TEST(Blank, IsZeroForVectorsAndFlatForPatches) {
  const std::vector<float> zero(4, 0.0F);
  const std::vector<float> flat(4, 127.5F);
  const std::vector<float> seen{127.5F, 127.5F, 127.5F, 128.0F};
  EXPECT_TRUE(blank(Difference::euclidean, zero));
  EXPECT_TRUE(blank(Difference::mean_absolute, zero));
  EXPECT_FALSE(blank(Difference::euclidean, flat));
  EXPECT_TRUE(blank(Difference::mean_absolute, flat));
  EXPECT_FALSE(blank(Difference::mean_absolute, seen));
  EXPECT_FALSE(blank(Difference::mean_absolute,
                     std::vector<float>(3, std::numeric_limits<float>::quiet_NaN())));
}

TEST(Finite, IsWhatHasNoInfinityAndNoNan) {
  using Limits = std::numeric_limits<float>;
  EXPECT_TRUE(all_finite({}));
  for (const std::size_t size : {1U, 7U, 64U, 735U}) {
    std::vector<float> values(size, -Limits::max());
    values[size / 2] = Limits::denorm_min();
    EXPECT_TRUE(all_finite(values)) << size;
    for (const float bad : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()}) {
      for (const std::size_t place : {std::size_t{0}, size / 2, size - 1}) {
        std::vector<float> one = values;
        one[place] = bad;
        EXPECT_FALSE(all_finite(one)) << bad << " at " << place << " of " << size;
      }
    }
  }
}

TEST(Contrast, EnhancesByHandAndIsNeverNegative) {
  // Rows 1, 2, 6 have mean 3 and sample deviation sqrt(7); the constant is 2 / sqrt(3).
  const Contrast contrast(2);
  EXPECT_EQ(contrast.reach(), 1U);
  const std::vector<float> column{1.0F, 2.0F, 6.0F, 6.0F, 6.0F};
  const double lift = 2.0 / std::sqrt(3.0);
  EXPECT_NEAR(contrast.enhance(column, 1, 1.0), lift - 1.0 / std::sqrt(7.0), 1e-6);
  EXPECT_NEAR(contrast.enhance(column, 0, 1.0), lift - std::sqrt(0.5), 1e-6)
      << "clipped to two rows";
  EXPECT_NEAR(contrast.enhance(column, 3, 1.0), lift, 1e-6) << "nothing deviates";
  EXPECT_NEAR(contrast.enhance(std::span(column).first(3), 2, 1.0), lift + std::sqrt(0.5), 1e-6)
      << "the map ends here";
  EXPECT_NEAR(contrast.enhance(std::span(column).first(1), 0, 1.0), lift, 1e-6) << "a single row";
  // The lowest that a sample can lie below its mean: one lower, all others equal.
  for (const std::size_t rwindow : {2U, 3U, 10U, 50U}) {
    const Contrast wide(rwindow);
    std::vector<float> dip(2 * wide.reach() + 1, 1.7F);
    dip[wide.reach()] = 0.1F;
    const float lowest = wide.enhance(dip, wide.reach(), 1.0);
    EXPECT_GE(lowest, 0.0F);
    EXPECT_NEAR(lowest, 0.0F, 1e-6);
  }
}

TEST(PaddedSize, IsTheNextWholeNumberOfLanes) {
  EXPECT_EQ(padded_size(0), 0U);
  EXPECT_EQ(padded_size(1), 16U);
  EXPECT_EQ(padded_size(16), 16U);
  EXPECT_EQ(padded_size(17), 32U);
}

TEST(Normalise, MakesUnitVectorsAndLeavesZeroAlone) {
  std::vector<float> vector{3.0F, 0.0F, -4.0F};
  EXPECT_TRUE(normalise(vector));
  EXPECT_EQ(vector, (std::vector<float>{0.6F, 0.0F, -0.8F}));
  std::vector<float> zero(5, 0.0F);
  EXPECT_FALSE(normalise(zero));
  EXPECT_EQ(zero, std::vector<float>(5, 0.0F));
  std::vector<float> tiny{1e-30F, 0.0F};
  EXPECT_TRUE(normalise(tiny));
  EXPECT_FLOAT_EQ(tiny[0], 1.0F);
}

TEST(Normalise, LeavesAloneWhatIsNotFinite) {
  using Limits = std::numeric_limits<float>;
  for (const float value : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()}) {
    std::vector<float> vector{3.0F, value, -4.0F};
    EXPECT_FALSE(normalise(vector)) << value;
    EXPECT_EQ(vector[0], 3.0F) << value;
    EXPECT_EQ(vector[2], -4.0F) << value;
  }
  std::vector<float> largest(3, Limits::max());
  EXPECT_TRUE(normalise(largest)) << "that is finite";
  EXPECT_FLOAT_EQ(largest[0], std::sqrt(1.0F / 3.0F));
  EXPECT_FALSE(normalise({}));
}

}  // namespace
}  // namespace seqloop
