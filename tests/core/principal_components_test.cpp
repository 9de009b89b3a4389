// SPDX-License-Identifier: MIT
// Beside the textbook: a dense P x P covariance matrix and its eigenvectors, by Jacobi rotations.
#include "seqloop/principal_components.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>

#include "expect_setup_error.hpp"

namespace seqloop {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Row = std::vector<double>;
using Matrix = std::vector<Row>;

/// [count, size], some values much more lively than others, so that the variances differ.
Bytes random_pictures(unsigned seed, std::size_t count, std::size_t size) {
  std::mt19937 random(seed);
  Bytes pictures;
  for (std::size_t i = 0; i < count * size; ++i) {
    const auto range = static_cast<int>(10 + 240 * (i % size) / size);
    pictures.push_back(
        static_cast<std::uint8_t>(std::uniform_int_distribution<int>(0, range)(random)));
  }
  return pictures;
}

struct Oracle {
  Row mean;
  Matrix components;  ///< largest variance first

  Oracle(const Bytes& pictures, std::size_t size) : mean(size) {
    const std::size_t count = pictures.size() / size;
    for (std::size_t i = 0; i < pictures.size(); ++i)
      mean[i % size] += pictures[i] / static_cast<double>(count);
    Matrix covariance(size, Row(size));
    for (std::size_t n = 0; n < count; ++n)
      for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < size; ++j)
          covariance[i][j] +=
              (pictures[n * size + i] - mean[i]) * (pictures[n * size + j] - mean[j]);
    components = eigenvectors(covariance);
  }

  /// Cyclic Jacobi: rows are unit eigenvectors, by falling eigenvalue.
  static Matrix eigenvectors(Matrix a) {
    const std::size_t size = a.size();
    Matrix vectors(size, Row(size));
    for (std::size_t i = 0; i < size; ++i) vectors[i][i] = 1.0;
    for (int sweep = 0; sweep < 50; ++sweep) {
      for (std::size_t p = 0; p < size; ++p) {
        for (std::size_t q = p + 1; q < size; ++q) {
          if (a[p][q] == 0.0) continue;
          const double angle = 0.5 * std::atan2(2.0 * a[p][q], a[p][p] - a[q][q]);
          const double c = std::cos(angle);
          const double s = std::sin(angle);
          const auto turn = [&](double& x, double& y) {
            const double before = x;
            x = c * before + s * y;
            y = c * y - s * before;
          };
          for (std::size_t i = 0; i < size; ++i) turn(a[i][p], a[i][q]);
          for (std::size_t i = 0; i < size; ++i) turn(a[p][i], a[q][i]);
          for (std::size_t i = 0; i < size; ++i) turn(vectors[p][i], vectors[q][i]);
        }
      }
    }
    std::vector<std::size_t> order(size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](auto x, auto y) { return a[x][x] > a[y][y]; });
    Matrix sorted;
    for (const std::size_t i : order) sorted.push_back(vectors[i]);
    return sorted;
  }

  [[nodiscard]] Row without(const Bytes& picture, std::size_t count) const {
    Row rest(picture.begin(), picture.end());
    for (std::size_t k = 0; k < count; ++k) {
      double coefficient = 0.0;
      for (std::size_t i = 0; i < mean.size(); ++i)
        coefficient += components[k][i] * (picture[i] - mean[i]);
      for (std::size_t i = 0; i < mean.size(); ++i) rest[i] -= coefficient * components[k][i];
    }
    return rest;
  }
};

template <class A, class B>
double product(const A& a, const B& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}

Bytes removed(PrincipalComponents& components, std::span<const std::uint8_t> picture) {
  Bytes out(picture.size());
  components.remove(picture, out);
  return out;
}

void expect_equal_to_oracle(std::size_t count, std::size_t size, std::size_t wanted) {
  SCOPED_TRACE(testing::Message() << count << " pictures of " << size << ", " << wanted);
  const Bytes pictures = random_pictures(3, count, size);
  PrincipalComponents learned(pictures, size, wanted);
  const Oracle oracle(pictures, size);
  ASSERT_EQ(learned.size(), size);
  ASSERT_EQ(learned.count(), std::min(wanted, size));
  for (std::size_t i = 0; i < size; ++i) EXPECT_NEAR(learned.mean()[i], oracle.mean[i], 1e-4);
  for (std::size_t k = 0; k < learned.count(); ++k) {
    EXPECT_NEAR(std::fabs(product(learned.component(k), oracle.components[k])), 1.0, 1e-5) << k;
  }
  const Bytes others = random_pictures(4, 20, size);
  for (std::size_t n = 0; n < 20; ++n) {
    const Bytes picture(others.begin() + static_cast<std::ptrdiff_t>(n * size),
                        others.begin() + static_cast<std::ptrdiff_t>((n + 1) * size));
    const Row exact = oracle.without(picture, learned.count());
    const Bytes got = removed(learned, picture);
    for (std::size_t i = 0; i < size; ++i)
      EXPECT_NEAR(got[i], std::clamp(exact[i], 0.0, 255.0), 0.501);
  }
}

TEST(PrincipalComponents, EqualTheEigenvectorsOfTheDenseCovariance) {
  expect_equal_to_oracle(2, 1, 1);
  expect_equal_to_oracle(2, 5, 1);
  expect_equal_to_oracle(6, 12, 0);
  expect_equal_to_oracle(6, 12, 5);
  expect_equal_to_oracle(30, 12, 4);
  expect_equal_to_oracle(30, 12, 29);
}

TEST(PrincipalComponents, AreOrthonormalAcrossTilesAndBlocks) {
  for (const std::size_t size : {255U, 256U, 257U, 1024U, 2500U}) {
    const PrincipalComponents learned(random_pictures(5, 9, size), size, 8);
    ASSERT_EQ(learned.count(), 8U);
    for (std::size_t k = 0; k < 8; ++k)
      for (std::size_t j = 0; j <= k; ++j)
        EXPECT_NEAR(product(learned.component(k), learned.component(j)), j == k ? 1.0 : 0.0, 1e-6);
  }
}

TEST(PrincipalComponents, AllOfThemLeaveTheMeanOfTheTrainingPictures) {
  constexpr std::size_t size = 3000;
  const Bytes pictures = random_pictures(6, 8, size);
  PrincipalComponents learned(pictures, size, 7);
  for (std::size_t n = 0; n < 8; ++n) {
    const Bytes got = removed(learned, std::span(pictures).subspan(n * size, size));
    for (std::size_t i = 0; i < size; ++i) ASSERT_NEAR(got[i], learned.mean()[i], 0.51);
  }
}

TEST(PrincipalComponents, NoneLeavesThePictureAsItIs) {
  const Bytes pictures = random_pictures(7, 3, 700);
  PrincipalComponents learned(pictures, 700, 0);
  EXPECT_EQ(learned.count(), 0U);
  EXPECT_EQ(removed(learned, std::span(pictures).first(700)),
            Bytes(pictures.begin(), pictures.begin() + 700));
}

TEST(PrincipalComponents, RoundsClampsAndWorksInPlace) {
  // They vary along (1, 0, 0) alone, around 100: what is left of the first value is 100.
  PrincipalComponents learned(Bytes{90, 7, 9, 110, 7, 9}, 3, 1);
  ASSERT_EQ(learned.count(), 1U);
  EXPECT_EQ(removed(learned, Bytes{255, 0, 255}), (Bytes{100, 0, 255}));
  // Along (1, -1) / sqrt(2), around (50, 50): (0, 255) becomes (127.5, 127.5), (255, 0) too.
  PrincipalComponents diagonal(Bytes{40, 60, 60, 40}, 2, 1);
  for (const int value : removed(diagonal, Bytes{0, 255})) EXPECT_NEAR(value, 127.5, 0.5);
  // Along (2, 1) / sqrt(5), around (100, 50): (0, 255) - (2, 1) * (-200 + 205) / 5 = (-2, 254)
  PrincipalComponents slope(Bytes{80, 40, 120, 60}, 2, 1);
  Bytes picture{0, 255};
  slope.remove(picture, picture);
  EXPECT_EQ(picture, (Bytes{0, 254}));
}

TEST(PrincipalComponents, SaysWhenPicturesVaryInFewerDirections) {
  const Bytes one = random_pictures(8, 1, 600);
  Bytes pictures;
  for (int copy = 0; copy < 5; ++copy) pictures.insert(pictures.end(), one.begin(), one.end());
  EXPECT_EQ(PrincipalComponents(pictures, 600, 4).count(), 0U);
  ++pictures[10];  // the least difference that there can be
  EXPECT_EQ(PrincipalComponents(pictures, 600, 4).count(), 1U);
  EXPECT_EQ(PrincipalComponents(Bytes(500, 128), 100, 3).count(), 0U);
}

TEST(PrincipalComponents, RefuseWhatCannotBeLearned) {
  using test::says;
  using test::setup_error;
  const auto fault = [](std::size_t bytes, std::size_t size, std::size_t components) {
    return setup_error(
        [&] { PrincipalComponents(random_pictures(1, 1, bytes), size, components); });
  };
  EXPECT_TRUE(says(fault(7, 2, 1), "not all of the same size"));
  EXPECT_TRUE(says(fault(0, 0, 1), "not all of the same size"));
  EXPECT_TRUE(says(fault(6, 2, 3), "3 cannot be learned from 3 training pictures"));
  EXPECT_TRUE(says(fault(0, 2, 0), "from 0 training pictures"));
  constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
  EXPECT_TRUE(says(fault(6, 2, most), std::to_string(most) + " cannot be learned"));
  const std::string both = fault(1001, 1, 1001);
  EXPECT_TRUE(says(both, "1001 are more than 1000"));
  EXPECT_TRUE(says(both, "1001 cannot be learned"));
}

}  // namespace
}  // namespace seqloop
