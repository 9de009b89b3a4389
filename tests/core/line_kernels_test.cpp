// SPDX-License-Identifier: MIT
// Sums along diagonals and the lowest lines through them, of whole numbers and of floats: every
// variant that this processor has, beside the definition, to the last bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/guarded.hpp"
#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"

namespace seqloop {
namespace {

using test::Guarded;

/// The kernels of one kind with what they sum up, and to what.
struct OfWholeNumbers {
  using Value = std::uint16_t;
  using Sum = std::uint32_t;
  static constexpr Sum highest = 0xFFFFFFFFU;
  static auto variants() { return integer_kernels(); }
  static Value value(std::mt19937& random) { return static_cast<Value>(random()); }
  /// Some wrap around.
  static Sum sum(std::uint32_t drawn) { return 0xFFFFFFFEU + drawn; }
};

struct OfFloats {
  using Value = float;
  using Sum = double;
  static constexpr Sum highest = 1e300;
  static auto variants() { return float_kernels(); }
  /// So far apart that sums in another order are others.
  static Value value(std::mt19937& random) {
    return std::ldexp(static_cast<float>(random()), -static_cast<int>(random() % 60));
  }
  static Sum sum(std::uint32_t drawn) { return drawn < 4 ? drawn : drawn / 7.0 - 3e8; }
};

template <class Kind>
class LineKernels : public testing::Test {
 protected:
  template <class Check>
  static void each(Check check) {
    for (const auto* kernels : Kind::variants()) {
      if (!kernels->supported()) continue;
      SCOPED_TRACE(std::string(kernels->name));
      check(*kernels);
    }
  }
};

using Kinds = testing::Types<OfWholeNumbers, OfFloats>;
TYPED_TEST_SUITE(LineKernels, Kinds);

TYPED_TEST(LineKernels, SumDiagonalsAsDefinedForEveryShapeAndReadNothingElse) {
  using Value = typename TypeParam::Value;
  using Sum = typename TypeParam::Sum;
  this->each([](const auto& kernels) {
    std::mt19937 random(17);
    for (const std::size_t window : {1U, 2U, 21U}) {
      for (const std::size_t count : {0U, 1U, 3U, 4U, 7U, 8U, 15U, 16U, 17U, 31U, 33U, 148U}) {
        const std::size_t stride = count + window % 3;
        std::vector<std::unique_ptr<Guarded<Value>>> columns;
        std::vector<const Value*> values;
        for (std::size_t i = 0; i < window; ++i) {
          std::vector<Value> column(count + 1);
          for (auto& value : column) value = TypeParam::value(random);
          values.push_back(columns.emplace_back(std::make_unique<Guarded<Value>>(column))->data());
        }
        std::vector<Sum> sums(window * stride + 1, Sum{77});
        std::vector<Sum> right = sums;
        for (std::size_t j = 0; j < count; ++j) {
          Sum apart = 0;
          Sum whole = 0;
          for (std::size_t i = 0; i < window; ++i) {
            right[i * stride + j] = apart;
            apart += static_cast<Sum>(values[i][j]) - static_cast<Sum>(values[i][j + 1]);
            whole += static_cast<Sum>(values[i][j]);
          }
          right[j] = whole;
        }
        kernels.sum_diagonals(values.data(), window, count, stride, sums.data());
        EXPECT_EQ(sums, right) << window << ' ' << count;
      }
    }
  });
}

/// What `lowest_lines` starts from and ends with.
template <class Sum>
struct Lowest {
  std::vector<Sum> best;
  std::vector<std::uint32_t> lines;
  bool operator==(const Lowest&) const = default;
};

/// Lines of every count of changes, up and down, as far as the sums reach.
struct SyntheticLines {
  static constexpr std::uint32_t furthest = 40;
  std::vector<LineThroughSums> lines;
  std::vector<std::uint32_t> changes;

  explicit SyntheticLines(std::mt19937& random) {
    std::uniform_int_distribution<std::uint32_t> offsets(0, furthest);
    for (const std::uint32_t count : {0U, 1U, 2U, 21U, 0U, 5U}) {
      const auto first = static_cast<std::uint32_t>(changes.size());
      for (std::uint32_t c = 0; c < count; ++c) changes.push_back(offsets(random));
      lines.push_back({offsets(random), first, first + count, lines.size() % 2 == 0});
    }
    lines[1].end = furthest;
    changes.back() = furthest;
  }
};

template <class Sum>
void keep_lower(const std::vector<Sum>& sums, const SyntheticLines& synthetic, std::uint32_t number,
                Lowest<Sum>& lowest) {
  for (const LineThroughSums& line : synthetic.lines) {
    for (std::size_t column = 0; column + 1 < lowest.best.size(); ++column) {
      Sum apart = 0;
      for (std::uint32_t c = line.first_change; c < line.last_change; ++c) {
        apart += sums[synthetic.changes[c] + column];
      }
      const Sum whole = sums[line.end + column];
      const Sum sum = line.rises ? whole + apart : whole - apart;
      if (sum >= lowest.best[column]) continue;
      lowest.best[column] = sum;
      lowest.lines[column] = number;
    }
    ++number;
  }
}

TYPED_TEST(LineKernels, KeepTheLowestLinesAsDefinedForEveryCountAndReadNothingElse) {
  using Sum = typename TypeParam::Sum;
  this->each([](const auto& kernels) {
    std::mt19937 random(9);
    for (std::size_t count = 0; count < 150; ++count) {
      // With ties.
      std::uniform_int_distribution<std::uint32_t> values(0, count % 2 == 0 ? 3U : 0xFFFFFFFFU);
      std::vector<Sum> sums(count + SyntheticLines::furthest);
      for (Sum& sum : sums) sum = TypeParam::sum(values(random));
      Lowest<Sum> right{std::vector<Sum>(count + 1, TypeParam::highest),
                        std::vector<std::uint32_t>(count + 1, 99)};
      Lowest<Sum> kept = right;
      const Guarded guarded(sums);
      for (std::uint32_t go = 0; go < 3; ++go) {
        const SyntheticLines synthetic(random);
        keep_lower(sums, synthetic, 10 * go, right);
        kernels.lowest_lines(guarded.data(), synthetic.changes.data(), synthetic.lines.data(),
                             synthetic.lines.size(), 10 * go, count, kept.best.data(),
                             kept.lines.data());
        ASSERT_EQ(kept, right) << count << ' ' << go;
      }
      EXPECT_EQ(kept.lines.back(), 99U) << "nothing is written behind";
    }
  });
}

TYPED_TEST(LineKernels, CompareWithoutASign) {
  using Sum = typename TypeParam::Sum;
  this->each([](const auto& kernels) {
    for (const std::size_t count : {1U, 9U, 200U}) {
      const std::vector<Sum> sums(count, 0);
      std::vector<Sum> high(count, Sum{0x80000001U});
      std::vector<std::uint32_t> lines(count, 5);
      const LineThroughSums nothing{0, 0, 0, true};
      kernels.lowest_lines(sums.data(), nullptr, &nothing, 1, 6, count, high.data(), lines.data());
      EXPECT_EQ(high, std::vector<Sum>(count, 0)) << count;
      EXPECT_EQ(lines, std::vector<std::uint32_t>(count, 6)) << count;
      kernels.lowest_lines(sums.data(), nullptr, &nothing, 1, 7, count, high.data(), lines.data());
      EXPECT_EQ(lines, std::vector<std::uint32_t>(count, 6)) << "of equal sums the first stays";
    }
  });
}

}  // namespace
}  // namespace seqloop
