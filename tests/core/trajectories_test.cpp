// SPDX-License-Identifier: MIT
// Lines through the window, beside their definition.
#include "seqloop/detail/trajectories.hpp"

#include "core/matcher.hpp"

namespace seqloop {
namespace {

TEST(Trajectories, OffsetsRoundHalfUpAndAreZeroAtTheCentre) {
  for (std::size_t ds = 1; ds <= 101; ++ds) {
    const VelocityRange range = velocity_range(ds, 0.8, 1.2);
    for (std::int64_t m = range.first; m <= range.last; ++m) {
      EXPECT_EQ(trajectory_offset(m, ds / 2, ds), 0);
      for (std::size_t i = 0; i <= ds; ++i) {
        const double exact = static_cast<double>(m) *
                             (static_cast<double>(i) - static_cast<double>(ds / 2)) /
                             static_cast<double>(ds);
        const auto offset = static_cast<double>(trajectory_offset(m, i, ds));
        EXPECT_LE(offset - exact, 0.5 + 1e-9) << ds << ' ' << m << ' ' << i;
        EXPECT_GT(offset - exact, -0.5 - 1e-9) << ds << ' ' << m << ' ' << i;
      }
    }
  }
  EXPECT_EQ(trajectory_offset(1, 0, 2), 0) << "-1/2 rounds up";
  EXPECT_EQ(trajectory_offset(1, 2, 2), 1) << "1/2 rounds up";
  EXPECT_EQ(trajectory_offset(3, 0, 2), -1) << "-3/2 rounds up";
}

TEST(Trajectories, CountsTheLinesThatDiffer) {
  EXPECT_EQ(velocity_range(100, 0.8, 1.2).count(), 41U);
  EXPECT_EQ(velocity_range(20, 0.8, 1.2).count(), 9U);
  EXPECT_EQ(velocity_range(1, 0.8, 1.2).count(), 1U);
  EXPECT_EQ(velocity_range(10, 1.1, 1.1).count(), 1U) << "1.1 * 10 is above 11 in binary";
  EXPECT_EQ(velocity_range(10, 1.01, 1.09).count(), 0U);
}

TEST(Trajectories, KnowItsLowestAndHighestOffsets) {
  TestArena memory;
  const Trajectories trajectories(memory.arena, 21, 0.8, 1.2);
  for (std::size_t i = 0; i < trajectories.window(); ++i) {
    for (std::size_t line = 0; line < trajectories.count(); ++line) {
      EXPECT_LE(trajectories.lowest(i), trajectories.offsets(line)[i]);
      EXPECT_GE(trajectories.highest(i), trajectories.offsets(line)[i]);
    }
  }
}

}  // namespace
}  // namespace seqloop
