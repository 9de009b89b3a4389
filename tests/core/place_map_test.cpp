// SPDX-License-Identifier: MIT
// A map says when it is full, and takes only what fits.
#include "seqloop/place_map.hpp"

#include <limits>
#include <random>
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

TEST(PlaceMap, TheFirstLinkSaysNothingOfTheRowsBeforeIt) {
  MatcherConfig config;
  config.standardisation.on = false;
  PlaceMap map(config, {50, 4});
  for (int place = 0; place < 50; ++place) EXPECT_TRUE(map.add(std::vector<float>(4, 0.5F)));
  map.link(30, 5);
  map.link(40, 15);
  EXPECT_EQ(map.first_visit(29), 29U);
  EXPECT_EQ(map.first_visit(30), 5U);
  EXPECT_EQ(map.first_visit(35), 10U) << "between two links";
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

std::vector<std::vector<float>> random_drive(unsigned seed, float mean) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(mean, 1.0F);
  std::vector<std::vector<float>> drive(60, std::vector<float>(5));
  for (auto& frame : drive) {
    for (float& value : frame) value = normal(random);
  }
  return drive;
}

/// Places are kept as what `known` makes of them, which moves on with them.
void expect_as_a_drive(const PlaceMap& map, std::size_t first, RunningStatistics& known,
                       const std::vector<std::vector<float>>& drive) {
  std::vector<float> wanted(5);
  std::vector<float> kept(map.rows().restored_size());
  for (std::size_t i = 0; i < drive.size(); ++i) {
    known.follow(drive[i], Standardisation{});
    known.standardise(drive[i], wanted);
    map.rows().restore(map.order().slot(first + i), kept);
    for (std::size_t d = 0; d < wanted.size(); ++d) EXPECT_EQ(kept[d], wanted[d]) << i;
  }
}

TEST(PlaceMap, PlacesAreStandardisedByWhatTheirSessionHasShown) {
  MatcherConfig config;
  config.arithmetic = Arithmetic::float32;
  config.keyframes = false;  // of five random features some hardly change
  PlaceMap map(config, {300, 5, 3});
  TestArena memory;

  const auto unknown = random_drive(1, 3.0F);
  for (const auto& place : unknown) ASSERT_TRUE(map.add(place));
  RunningStatistics from_the_first(memory.arena, 5);
  expect_as_a_drive(map, 0, from_the_first, unknown);

  ASSERT_TRUE(map.begin_session());
  const auto learnt = random_drive(2, -4.0F);
  RunningStatistics whole(memory.arena, 5);
  for (const auto& place : learnt) {
    ASSERT_TRUE(map.learn(place));
    whole.observe(place);
  }
  for (const auto& place : learnt) ASSERT_TRUE(map.add(place));
  RunningStatistics from_the_whole(memory.arena, 5);
  from_the_whole.start_from(whole, Standardisation{}.prior_frames);
  expect_as_a_drive(map, unknown.size(), from_the_whole, learnt);

  ASSERT_TRUE(map.begin_session());
  ASSERT_TRUE(map.add(learnt.back()));
  RunningStatistics anew(memory.arena, 5);
  anew.start_from(whole, Standardisation{}.prior_frames);
  expect_as_a_drive(map, unknown.size() + learnt.size(), anew, {learnt.back()});
}

}  // namespace
}  // namespace seqloop
