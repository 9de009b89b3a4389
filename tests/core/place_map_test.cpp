// SPDX-License-Identifier: MIT
// A map says when it is full, and takes only what fits.
#include "seqloop/place_map.hpp"

#include <limits>
#include <vector>

#include "core/matcher.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

TEST(PlaceMap, SaysWhenItIsFullAndStaysAsItWas) {
  PlaceMap map(paper(Candidates::all, 2), {2, 3});
  EXPECT_TRUE(map.add(std::vector<float>{1.0F, 0.0F, 0.0F}));
  EXPECT_TRUE(map.add(std::vector<float>{0.0F, 1.0F, 0.0F}));
  EXPECT_FALSE(map.add(std::vector<float>{0.0F, 0.0F, 1.0F}));
  EXPECT_EQ(map.size(), 2U);
  std::vector<float> kept(map.rows().restored_size());
  map.rows().restore(1, kept);
  EXPECT_EQ(kept.size(), padded_size(3));
  EXPECT_EQ(kept[1], 1.0F);
  EXPECT_EQ(kept[15], 0.0F);
}

TEST(PlaceMap, TakesOnlyWhatFits) {
  PlaceMap map({}, {3, 2});
  EXPECT_FALSE(map.learn(std::vector<float>(4000, 1.0F)));
  EXPECT_TRUE(map.learn(std::vector<float>{1.0F, 0.0F}));
  EXPECT_FALSE(map.add(std::vector<float>(4000, 1.0F)));
  EXPECT_FALSE(map.add(std::vector<float>(1, 1.0F)));
  EXPECT_FALSE(map.add(std::vector<float>{1.0F, std::numeric_limits<float>::quiet_NaN()}));
  EXPECT_TRUE(map.add(std::vector<float>{1.0F, 0.0F}));
  EXPECT_FALSE(map.learn(std::vector<float>{1.0F, 0.0F}))
      << "places would not be standardised by it";
  EXPECT_TRUE(map.add(std::vector<float>{0.0F, 1.0F}));
}

}  // namespace
}  // namespace seqloop
