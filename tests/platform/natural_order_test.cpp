// SPDX-License-Identifier: MIT
#include "opencv/detail/natural_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace seqloop::opencv {
namespace {

TEST(NaturalOrder, SortsNumbersAsNumbers) {
  const std::vector<std::string> sorted{"",
                                        "1.jpg",
                                        "2.jpg",
                                        "10.jpg",
                                        "100000000000000000000000.jpg",
                                        "Image9.jpg",
                                        "image.jpg",
                                        "image1.jpg",
                                        "image1b.jpg",
                                        "image01c.jpg",
                                        "image2.jpg",
                                        "image10.jpg",
                                        "image10_2.jpg",
                                        "image10_10.jpg",
                                        "imagf.jpg"};
  std::vector<std::string> names = sorted;
  do {
    std::vector<std::string> result = names;
    std::sort(result.begin(), result.end(), natural_less);
    ASSERT_EQ(result, sorted);
    std::rotate(names.begin(), names.begin() + 1, names.end());
  } while (names != sorted);
}

TEST(NaturalOrder, LeadingZerosDecideOnlyBetweenEqualNumbers) {
  EXPECT_TRUE(natural_less("a01", "a1"));
  EXPECT_FALSE(natural_less("a1", "a01"));
  EXPECT_TRUE(natural_less("a1", "a02"));
  EXPECT_TRUE(natural_less("a01b1", "a1b2"));
  EXPECT_FALSE(natural_less("a1", "a1"));
}

}  // namespace
}  // namespace seqloop::opencv
