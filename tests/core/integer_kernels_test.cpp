// SPDX-License-Identifier: MIT
// Every variant that this processor has, beside the definition, to the last bit.
#include "seqloop/detail/integer_kernels.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "core/guarded.hpp"

namespace seqloop {
namespace {

using test::Guarded;

using Bytes = std::vector<std::int8_t>;
using Words = std::vector<std::uint64_t>;

constexpr std::array<std::size_t, 18> sizes{0,  1,   2,   31,  32,  33,  63,   64,   65,
                                            96, 127, 128, 129, 191, 735, 1000, 4097, 9216};

std::int32_t product(const std::int8_t* a, const std::int8_t* b, std::size_t size) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < size; ++i) sum += std::int64_t{a[i]} * std::int64_t{b[i]};
  return static_cast<std::int32_t>(sum);
}

std::uint32_t bits_apart(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) {
  std::uint32_t sum = 0;
  for (std::size_t bit = 0; bit < words * 64; ++bit) {
    sum += static_cast<std::uint32_t>(((a[bit / 64] ^ b[bit / 64]) >> (bit % 64)) & 1U);
  }
  return sum;
}

Bytes random_bytes(std::mt19937& random, std::size_t size) {
  std::uniform_int_distribution<int> values(-127, 127);
  Bytes bytes(size);
  for (std::int8_t& value : bytes) value = static_cast<std::int8_t>(values(random));
  return bytes;
}

Words random_words(std::mt19937_64& random, std::size_t size) {
  Words words(size);
  for (std::uint64_t& word : words) word = random();
  return words;
}

class Variant : public testing::TestWithParam<const IntegerKernels*> {
 protected:
  void SetUp() override {
    if (!kernels_.supported()) GTEST_SKIP() << "this processor has no " << kernels_.name;
  }
  const IntegerKernels& kernels_ = *GetParam();
};

TEST_P(Variant, DotEqualsTheDefinitionForEverySizeAndReadsNothingElse) {
  std::mt19937 random(1);
  for (const std::size_t size : sizes) {
    const Bytes a = random_bytes(random, size);
    const Bytes b = random_bytes(random, size);
    const Guarded guarded_a(a);
    const Guarded guarded_b(b);
    EXPECT_EQ(kernels_.dot(guarded_a.data(), guarded_b.data(), size),
              product(a.data(), b.data(), size))
        << size;
  }
}

TEST_P(Variant, DotEqualsTheDefinitionAtEveryAlignment) {
  std::mt19937 random(2);
  const Bytes a = random_bytes(random, 400);
  const Bytes b = random_bytes(random, 400);
  for (std::size_t offset_a = 0; offset_a < 64; ++offset_a) {
    for (std::size_t offset_b = 0; offset_b < 64; ++offset_b) {
      const std::size_t size = 193 + (offset_a + offset_b) % 70;
      ASSERT_EQ(kernels_.dot(a.data() + offset_a, b.data() + offset_b, size),
                product(a.data() + offset_a, b.data() + offset_b, size))
          << offset_a << ' ' << offset_b;
    }
  }
}

TEST_P(Variant, DotHoldsTheLargestThatItPromises) {
  const Bytes high(most_small_values, 127);
  const Bytes low(most_small_values, -127);
  constexpr std::int32_t most = 127 * 127 * std::int32_t{most_small_values};
  EXPECT_EQ(kernels_.dot(high.data(), high.data(), high.size()), most);
  EXPECT_EQ(kernels_.dot(low.data(), low.data(), low.size()), most);
  EXPECT_EQ(kernels_.dot(high.data(), low.data(), low.size()), -most);
  EXPECT_EQ(kernels_.dot(low.data(), high.data(), low.size()), -most);
  std::int32_t column = 0;
  kernels_.dot_column(low.data(), high.data(), high.size(), 1, &column);
  EXPECT_EQ(column, -most);
}

TEST_P(Variant, DotColumnEqualsTheDefinitionForEverySizeAndReadsNothingElse) {
  std::mt19937 random(3);
  for (const std::size_t size : sizes) {
    const std::size_t stride = padded_bytes(size);
    for (const std::size_t count : {0U, 1U, 2U, 3U, 4U, 5U, 7U, 8U, 13U}) {
      Bytes query = random_bytes(random, size);
      query.resize(stride, 0);
      const Bytes rows = random_bytes(random, stride * count);
      const Guarded guarded_query(query);
      const Guarded guarded_rows(rows);
      std::vector<std::int32_t> dots(count + 1, 77);
      kernels_.dot_column(guarded_query.data(), guarded_rows.data(), stride, count, dots.data());
      for (std::size_t row = 0; row < count; ++row) {
        ASSERT_EQ(dots[row], product(query.data(), rows.data() + row * stride, stride))
            << size << ' ' << row << " of " << count;
      }
      EXPECT_EQ(dots[count], 77) << "nothing is written behind";
    }
  }
}

TEST_P(Variant, DotColumnEqualsTheDefinitionAtEveryAlignment) {
  std::mt19937 random(4);
  constexpr std::size_t stride = 192;
  constexpr std::size_t count = 6;
  const Bytes query = random_bytes(random, stride + 64);
  const Bytes rows = random_bytes(random, stride * count + 64);
  std::vector<std::int32_t> dots(count);
  for (std::size_t offset = 0; offset < 64; ++offset) {
    const std::int8_t* from = query.data() + (63 - offset);
    kernels_.dot_column(from, rows.data() + offset, stride, count, dots.data());
    for (std::size_t row = 0; row < count; ++row) {
      ASSERT_EQ(dots[row], product(from, rows.data() + offset + row * stride, stride)) << offset;
    }
  }
}

TEST_P(Variant, DotBlockEqualsTheDefinitionForEveryShapeAndReadsNothingElse) {
  std::mt19937 random(7);
  for (const std::size_t size : {0U, 1U, 64U, 65U, 735U}) {
    const std::size_t stride = padded_bytes(size);
    for (std::size_t queries_count = 0; queries_count < 19; ++queries_count) {
      for (const std::size_t count : {0U, 1U, 2U, 3U, 7U, 13U}) {
        const Bytes queries = random_bytes(random, stride * queries_count);
        const Bytes rows = random_bytes(random, stride * count);
        const Guarded guarded_queries(queries);
        const Guarded guarded_rows(rows);
        const std::size_t out_stride = count + queries_count % 3;
        std::vector<std::int32_t> dots(queries_count * out_stride + 1, 77);
        kernels_.dot_block(guarded_queries.data(), queries_count, guarded_rows.data(), stride,
                           count, dots.data(), out_stride);
        for (std::size_t query = 0; query < queries_count; ++query) {
          const std::int8_t* from = queries.data() + query * stride;
          for (std::size_t row = 0; row < out_stride; ++row) {
            const std::int32_t right =
                row < count ? product(from, rows.data() + row * stride, stride) : 77;
            ASSERT_EQ(dots[query * out_stride + row], right)
                << size << ' ' << query << " of " << queries_count << ' ' << row << " of " << count;
          }
        }
        EXPECT_EQ(dots.back(), 77) << "nothing is written behind";
      }
    }
  }
}

TEST_P(Variant, DotBlockIsTheSameInParts) {
  // So long that rows and queries are taken in parts, of which none is as long as another.
  constexpr std::size_t stride = 70 * 1024 + 64;
  constexpr std::size_t queries_count = 11;
  constexpr std::size_t count = 9;
  std::mt19937 random(8);
  const Bytes queries = random_bytes(random, stride * queries_count + 64);
  const Bytes rows = random_bytes(random, stride * count + 64);
  for (const std::size_t offset : {0U, 1U, 63U}) {
    const std::int8_t* from = queries.data() + offset;
    const std::int8_t* to = rows.data() + (63 - offset);
    std::vector<std::int32_t> dots(queries_count * count);
    kernels_.dot_block(from, queries_count, to, stride, count, dots.data(), count);
    for (std::size_t query = 0; query < queries_count; ++query) {
      for (std::size_t row = 0; row < count; ++row) {
        ASSERT_EQ(dots[query * count + row],
                  product(from + query * stride, to + row * stride, stride))
            << offset << ' ' << query << ' ' << row;
      }
    }
  }
}

TEST_P(Variant, DotBlockHoldsTheLargestThatItPromises) {
  const Bytes high(8 * most_small_values, 127);
  const Bytes low(2 * most_small_values, -127);
  constexpr std::int32_t most = 127 * 127 * std::int32_t{most_small_values};
  std::vector<std::int32_t> dots(16);
  kernels_.dot_block(high.data(), 8, low.data(), most_small_values, 2, dots.data(), 2);
  EXPECT_EQ(dots, std::vector<std::int32_t>(16, -most));
}

TEST_P(Variant, HammingEqualsTheDefinitionForEverySizeAndReadsNothingElse) {
  std::mt19937_64 random(5);
  for (std::size_t words = 0; words < 70; ++words) {
    const Words a = random_words(random, words);
    const Words b = random_words(random, words);
    const Guarded guarded_a(a);
    const Guarded guarded_b(b);
    EXPECT_EQ(kernels_.hamming(guarded_a.data(), guarded_b.data(), words),
              bits_apart(a.data(), b.data(), words))
        << words;
  }
}

TEST_P(Variant, HammingCountsNoneAllAndEachSingleBit) {
  // Longer than what a byte can count in one lane.
  constexpr std::size_t words = 4099;
  const Words none(words, 0);
  const Words all(words, ~std::uint64_t{0});
  EXPECT_EQ(kernels_.hamming(none.data(), none.data(), words), 0U);
  EXPECT_EQ(kernels_.hamming(all.data(), all.data(), words), 0U);
  EXPECT_EQ(kernels_.hamming(none.data(), all.data(), words), words * 64);
  for (std::size_t bit = 0; bit < 9 * 64; ++bit) {
    Words one(9, 0);
    one[bit / 64] = std::uint64_t{1} << (bit % 64);
    EXPECT_EQ(kernels_.hamming(none.data(), one.data(), 9), 1U) << bit;
  }
}

TEST_P(Variant, HammingColumnEqualsTheDefinitionForEveryShapeAndReadsNothingElse) {
  std::mt19937_64 random(6);
  for (const std::size_t words : {0U, 1U, 3U, 4U, 5U, 7U, 8U, 9U, 12U, 28U, 31U, 32U, 33U}) {
    for (const std::size_t count : {0U, 1U, 2U, 3U, 4U, 5U, 9U}) {
      const Words query = random_words(random, words);
      const Words rows = random_words(random, words * count);
      const Guarded guarded_query(query);
      const Guarded guarded_rows(rows);
      std::vector<std::uint32_t> bits(count + 1, 77);
      kernels_.hamming_column(guarded_query.data(), guarded_rows.data(), words, count, bits.data());
      for (std::size_t row = 0; row < count; ++row) {
        ASSERT_EQ(bits[row], bits_apart(query.data(), rows.data() + row * words, words))
            << words << ' ' << row << " of " << count;
      }
      EXPECT_EQ(bits[count], 77U) << "nothing is written behind";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(IntegerKernels, Variant,
                         testing::ValuesIn(integer_kernels().begin(), integer_kernels().end()),
                         [](const auto& test) {
                           std::string name(test.param->name);
                           std::erase(name, '-');
                           return name;
                         });

TEST(IntegerKernels, HaveOneNameEachAndEndWithPlainCode) {
  const auto variants = integer_kernels();
  ASSERT_FALSE(variants.empty());
  EXPECT_EQ(variants.back()->name, "scalar");
  EXPECT_TRUE(variants.back()->supported());
  for (std::size_t i = 0; i < variants.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(variants[i]->name, variants[j]->name);
  }
}

TEST(IntegerKernels, BestIsTheFirstThatTheProcessorHas) {
  for (const IntegerKernels* kernels : integer_kernels()) {
    if (!kernels->supported()) continue;
    EXPECT_EQ(&best_integer_kernels(), kernels);
    break;
  }
}

TEST(PaddedBytes, AreWholeCacheLines) {
  EXPECT_EQ(padded_bytes(0), 0U);
  EXPECT_EQ(padded_bytes(1), 64U);
  EXPECT_EQ(padded_bytes(64), 64U);
  EXPECT_EQ(padded_bytes(735), 768U);
}

}  // namespace
}  // namespace seqloop
