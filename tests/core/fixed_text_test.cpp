// SPDX-License-Identifier: MIT
#include "seqloop/fixed_text.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace seqloop {
namespace {

TEST(FixedText, NumbersAreWrittenWhole) {
  FixedText text;
  text.append_number(0);
  text.append(" to ");
  text.append_number(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(text.view(), "0 to 18446744073709551615");
}

TEST(FixedText, WhatIsTooLongIsCut) {
  FixedText text;
  text.append(std::string(FixedText::capacity - 2, 'x'));
  text.append_number(1234);
  EXPECT_EQ(text.view().size(), FixedText::capacity);
  EXPECT_TRUE(text.view().ends_with("x12"));
}

}  // namespace
}  // namespace seqloop
