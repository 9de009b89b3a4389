// SPDX-License-Identifier: MIT
#include "seqloop/files/descriptor_source.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "seqloop/fault.hpp"

namespace seqloop::files {
namespace {

TEST(DescriptorSource, HandsOverEveryRowInOrder) {
  DescriptorSource source({2, 3, {1, 2, 3, 4, 5, 6}}, 4.0);
  EXPECT_EQ(source.size(), 3U);
  EXPECT_EQ(source.frame_count(), 2U);
  Frame frame;
  ASSERT_EQ(source.grab(frame), Grab::frame);
  EXPECT_EQ(frame.index, 0U);
  EXPECT_EQ(frame.descriptor[2], 3.0F);
  ASSERT_EQ(source.grab(frame), Grab::frame);
  EXPECT_EQ(frame.index, 1U);
  EXPECT_EQ(frame.time_s, 0.25);
  EXPECT_EQ(frame.descriptor.size(), 3U);
  EXPECT_EQ(frame.descriptor[0], 4.0F);
  EXPECT_EQ(frame.image.data, nullptr);
  EXPECT_EQ(source.grab(frame), Grab::end);
  EXPECT_TRUE(frame.descriptor.empty());
  EXPECT_EQ(source.grab(frame), Grab::end);
}

// Bad input: a frame rate that gives no times.
TEST(DescriptorSource, RefusesAFrameRateThatIsNotPositive) {
  for (const double rate : {0.0, -1.0, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(DescriptorSource({1, 1, {1}}, rate), SetupError);
}

}  // namespace
}  // namespace seqloop::files
