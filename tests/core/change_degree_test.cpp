// SPDX-License-Identifier: MIT
// The change degree beside Eq. (4).
#include "seqloop/detail/change_degree.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

TEST(ChangeDegree, EqualsEquationFourAndNamesItsEdges) {
  TestArena memory;
  QueryHistory queries(memory.arena, DescriptorForm(paper(Candidates::all, 2), 2), 12);
  ChangeDegree degree;
  std::vector<std::vector<float>> frames;
  const auto see = [&](float a, float b) {
    frames.push_back({a, b});
    queries.push(frames.back());
    return degree.advance(queries, frames.size() - 1);
  };
  for (int frame = 0; frame < 11; ++frame) {
    EXPECT_EQ(see(static_cast<float>(frame % 3), 1.0F), 1.0) << "fewer than 11 earlier frames";
  }
  const double given = see(5.0F, 2.0F);
  double above = 0.0;
  double below = 0.0;
  const auto apart = [&](std::size_t a, std::size_t b) {
    return std::hypot(static_cast<double>(frames[a][0] - frames[b][0]),
                      static_cast<double>(frames[a][1] - frames[b][1]));
  };
  for (std::size_t i = 1; i <= 10; ++i) {
    above += apart(11, i);
    below += apart(10, i - 1);
  }
  EXPECT_NEAR(given, above / below, 1e-6) << "exactly 11 earlier frames";
  for (int frame = 0; frame < 11; ++frame) (void)see(7.0F, 7.0F);
  EXPECT_EQ(see(7.0F, 7.0F), 1.0) << "0/0: the robot stands";
  EXPECT_EQ(see(8.0F, 7.0F), std::numeric_limits<double>::infinity()) << "x/0: it starts";
}

}  // namespace
}  // namespace seqloop
