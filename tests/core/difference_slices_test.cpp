// SPDX-License-Identifier: MIT
// Differences are computed once, where asked, and stay right when the ring wraps.
#include "seqloop/detail/difference_slices.hpp"

#include <cmath>
#include <vector>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

class Slices : public testing::Test {
 protected:
  static constexpr Capacity capacity{6, 20};
  const MatcherConfig config_ = paper(Candidates::all, 2);
  oracle::Vectors drive_ = oracle::drive(21, 30, 20);
  PlaceMap map_ = map_of({drive_.begin(), drive_.begin() + 6}, config_);
  TestArena memory_;
  QueryHistory queries_{memory_.arena, DescriptorForm(config_, 20), 5};
  DifferenceSlices slices_{memory_.arena, config_, queries_, capacity};

  void push(std::size_t frame) { queries_.push(drive_[frame]); }

  std::vector<float> column(const DifferenceSlices& slices, std::uint64_t frame) const {
    std::vector<float> shown(6);
    slices.show(map_, frame, shown);
    return shown;
  }
};

TEST_F(Slices, ComputeADifferenceOnceAndOnlyWhereAsked) {
  push(0);
  EXPECT_EQ(slices_.missing(map_, 0, 2, 4), 2U);
  EXPECT_EQ(slices_.fill(map_, 0, 2, 4), 2U);
  EXPECT_LT(column(slices_, 0)[1], 0.0F) << "not asked for";
  EXPECT_EQ(slices_.fill(map_, 0, 2, 4), 0U);
  EXPECT_EQ(slices_.missing(map_, 0, 0, 6), 4U);
  EXPECT_EQ(slices_.fill(map_, 0, 0, 6), 4U);
  EXPECT_EQ(slices_.fill(map_, 0, 0, 6), 0U);
  EXPECT_EQ(slices_.missing(map_, 0, 0, 6), 0U);
  EXPECT_EQ(slices_.fill(map_, 0, 3, 3), 0U);
}

TEST_F(Slices, HoldTheRightColumnAfterWrappingTwice) {
  for (std::size_t frame = 0; frame < 7; ++frame) {
    push(frame);
    for (std::size_t kept = frame < 2 ? 0 : frame - 2; kept <= frame; ++kept) {
      const bool fresh = kept == frame;
      EXPECT_EQ(slices_.fill(map_, kept, 0, 6), fresh ? 6U : 0U) << frame << ' ' << kept;
      const std::vector<float> shown = column(slices_, kept);
      for (std::size_t row = 0; row < 6; ++row) {
        double sum = 0.0;
        for (std::size_t d = 0; d < 20; ++d) {
          sum += std::pow(
              static_cast<double>(drive_[kept][d]) - static_cast<double>(drive_[row][d]), 2.0);
        }
        EXPECT_NEAR(shown[row], std::sqrt(sum), 1e-6);
      }
    }
  }
}

TEST_F(Slices, EnhancedOnesComputeTheRowsAroundOnce) {
  for (const Arithmetic arithmetic : {Arithmetic::float32, Arithmetic::int8}) {
    TestArena memory;
    MatcherConfig config = config_;
    config.arithmetic = arithmetic;
    config.enhance = true;
    config.rwindow = 2;
    PlaceMap map = map_of({drive_.begin(), drive_.begin() + 6}, config);
    QueryHistory queries(memory.arena, DescriptorForm(config, 20), 5);
    queries.push(drive_[3]);
    DifferenceSlices enhanced(memory.arena, config, queries, capacity);
    EXPECT_EQ(enhanced.fill(map, 0, 3, 3), 0U);
    EXPECT_EQ(enhanced.missing(map, 0, 2, 4), 4U);
    EXPECT_EQ(enhanced.fill(map, 0, 2, 4), 4U) << "one row on either side";
    EXPECT_LT(column(enhanced, 0)[1], 0.0F) << "not asked for";
    EXPECT_EQ(enhanced.fill(map, 0, 1, 5), 2U);
    EXPECT_EQ(enhanced.fill(map, 0, 0, 6), 0U) << "the ends are clipped to the map";
    TestArena plain;
    config.enhance = false;
    DifferenceSlices differences(plain.arena, config, queries, capacity);
    differences.fill(map, 0, 0, 6);
    const std::vector<float> column_of_3 = column(differences, 0);
    for (std::size_t row = 0; row < 6; ++row) {
      EXPECT_NEAR(column(enhanced, 0)[row], Contrast(2).enhance(column_of_3, row, 1.0), 1e-4);
    }
  }
}

}  // namespace
}  // namespace seqloop
