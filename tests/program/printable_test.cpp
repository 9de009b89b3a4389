// SPDX-License-Identifier: MIT
// Text from outside on its way to a terminal.
#include "program/process/say.hpp"

#include <gtest/gtest.h>

namespace seqloop::program {
namespace {

TEST(Printable, WhatATerminalOnlyShowsStaysAsItIs) {
  for (const std::string text :
       {"", "a/b c.npy: it is no 'NumPy' file; <see> ~", "Zürich → 東京 🚗"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, WhatATerminalObeysIsSpelled) {
  EXPECT_EQ(printable("\x1B[2J\x07"), "\\x1B[2J\\x07");
  EXPECT_EQ(printable("a\nb\tc\r\x7F"), "a\\x0Ab\\x09c\\x0D\\x7F");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\xC2\\x9B31m")
      << "one character that is an escape";
  EXPECT_EQ(printable("gpj.\xE2\x80\xAE"), "gpj.\\xE2\\x80\\xAE") << "from right to left";
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "\\x00x");
}

TEST(Printable, BytesThatAreNoUtf8AreSpelled) {
  EXPECT_EQ(printable("\xFF"
                      "a\xC3"),
            "\\xFFa\\xC3");
  EXPECT_EQ(printable("\xC0\xAF"), "\\xC0\\xAF") << "an over-long slash";
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xED\\xA0\\x80") << "a surrogate";
}

TEST(Printable, OfALongLineTheStartAndTheEndAreLeft) {
  EXPECT_EQ(printable(std::string(4'000, 'a')), std::string(4'000, 'a'));
  const std::string line = printable("m.csv:3: '" + std::string(10'000'000, '7') + "'; see --help");
  EXPECT_LT(line.size(), 5'000U);
  EXPECT_TRUE(line.starts_with("m.csv:3: '7777"));
  EXPECT_TRUE(line.ends_with("7777'; see --help"));
  EXPECT_NE(line.find("bytes"), std::string::npos);
}

TEST(Printable, LinesStayLines) {
  EXPECT_EQ(printable_lines("a\x1B\n\nb"), "a\\x1B\n\nb");
  EXPECT_EQ(printable_lines("a\n"), "a\n");
}

}  // namespace
}  // namespace seqloop::program
