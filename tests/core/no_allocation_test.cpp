// SPDX-License-Identifier: MIT
// A step takes no memory, and the guard that says so can fail.
#include <algorithm>
#include <cstdlib>
#include <memory>

#include "core/allocation_guard.hpp"
#include "core/matcher.hpp"
#include "core/panorama.hpp"
#include "core/ways.hpp"
#include "seqloop/principal_components.hpp"
#include "seqloop/visit_finder.hpp"

namespace seqloop {
namespace {

class NoAllocation : public testing::Test {
 protected:
  void SetUp() override {
    if (!AllocationGuard::works()) GTEST_SKIP() << "a sanitizer's heap cannot be counted";
  }
};

TEST_F(NoAllocation, TheGuardFires) {
  const AllocationGuard guard;
  EXPECT_EQ(guard.count(), 0U);
  int* volatile with_new = new int(1);
  EXPECT_EQ(guard.count(), 1U);
  delete with_new;
  void* volatile with_malloc = std::malloc(8);
  EXPECT_EQ(guard.count(), 2U);
  with_malloc = std::realloc(with_malloc, 4000);
  EXPECT_EQ(guard.count(), 3U);
  std::free(with_malloc);
  const ArenaMemory aligned(64, {});
  EXPECT_EQ(guard.count(), 4U);
}

std::size_t matches(const FrameReport& report) {
  return static_cast<std::size_t>(std::ranges::count_if(
      report.answers, [](const Answer& answer) { return answer.match.has_value(); }));
}

TEST_F(NoAllocation, WhereNotEachFrameIsAKeyframe) {
  const oracle::Vectors slow = test::slowly(test::way(1, 200, 0.3F, 1), 6, 1);
  const MatcherConfig config;
  PlaceMap map = map_of(slow, config);
  Detector detector(config, map);
  const AllocationGuard guard;
  std::size_t answers = 0;
  for (const auto& descriptor : slow) answers += detector.step(descriptor).answers.size();
  answers += detector.finish().size();
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(answers, slow.size());
  EXPECT_LT(map.size(), slow.size() / 2);
}

TEST_F(NoAllocation, WhereFramesAreMovedToTheSide) {
  const test::Panorama panorama(1, 200);
  const MatcherConfig config;
  PlaceMap map = map_of(panorama.seen(7, 0.5F, 1), config);
  ASSERT_TRUE(map.set_columns(test::Panorama::columns));
  const oracle::Vectors drive = panorama.seen(9, 0.5F, 2);
  Detector detector(config, map);
  std::size_t answers = 0;
  const AllocationGuard guard;
  for (const auto& descriptor : drive) answers += matches(detector.step(descriptor));
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_GT(answers, 0U);
}

TEST_F(NoAllocation, WherePlacesOfOthersAreTakenIn) {
  const oracle::Vectors one = oracle::drive(32, 150, 40, 0.2F);
  const oracle::Vectors other = oracle::drive(33, 150, 40, 0.2F);
  MatcherConfig config;
  config.full_map = FullMap::forget_oldest;
  const PlaceMap places = map_of(other, config);
  PlaceMap map(config, {300, 40, 2});
  Detector detector(config, map);
  std::vector<std::byte> bytes(map.rows().saved_size());
  const AllocationGuard guard;
  for (std::size_t frame = 0; frame < 150; ++frame) {
    for (const std::size_t session : {0U, 1U}) {
      if (frame == 0 && session == 1) {
        map.count_from(1'000);
        ASSERT_TRUE(map.begin_session());
      }
      places.rows().save(frame, bytes);
      ASSERT_TRUE(detector.take_in(session, {session * 1'000 + frame, frame, bytes}));
    }
    static_cast<void>(detector.step(one[frame]));
  }
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(map.size(), 300U);
}

TEST_F(NoAllocation, InAnyStepOfAnyMethodInAnyUse) {
  const oracle::Vectors lap = oracle::drive(31, 150, 40, 0.2F);
  for (const Candidates candidates : {Candidates::all, Candidates::ranges, Candidates::adaptive}) {
    for (const Use use : {Use::localise, Use::close_loops}) {
      for (const bool beyond : {false, true}) {  // SeqSLAM's comparison, standardised too
        MatcherConfig config;
        config.arithmetic = beyond ? Arithmetic::float32 : Arithmetic::int8;
        config.relocalising.on = !beyond;
        config.difference = beyond ? Difference::mean_absolute : Difference::euclidean;
        config.enhance = beyond;
        config.candidates = candidates;
        config.use = use;
        config.exclude = 30;
        config.reinit = 20;
        config.standardisation.on = beyond;
        PlaceMap map = use == Use::localise ? map_of(lap, config) : PlaceMap(config, {200, 40});
        Detector detector(config, map);
        std::size_t matched = 0;
        const AllocationGuard guard;
        for (int repeat = 0; repeat < 2; ++repeat) {
          for (const auto& descriptor : lap) {
            matched += matches(detector.step(descriptor));
          }
          matched += matches(detector.step({}));
          detector.skip(7);
          detector.skip(1000);
        }
        EXPECT_EQ(guard.count(), 0U);
        EXPECT_GT(matched, 100U);
      }
    }
  }
}

TEST_F(NoAllocation, InTheLastAnswersOfADrive) {
  const MatcherConfig config;
  const oracle::Vectors lap = oracle::drive(31, 150, 40, 0.2F);
  PlaceMap map = map_of(lap, config);
  Detector detector(config, map);
  std::size_t answered = 0;
  for (const auto& descriptor : lap) answered += detector.step(descriptor).answers.size();
  const AllocationGuard guard;
  answered += detector.finish().size();
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(answered, lap.size());
  EXPECT_TRUE(detector.finish().empty());
}

TEST_F(NoAllocation, WhenAFullMapMakesRoom) {
  const oracle::Vectors lap = oracle::drive(32, 150, 40, 0.2F);
  for (const Arithmetic arithmetic : {Arithmetic::float32, Arithmetic::int8, Arithmetic::sketch}) {
    for (const FullMap full_map : {FullMap::forget_oldest, FullMap::thin}) {
      for (const bool relocalising : {false, true}) {
        MatcherConfig config;
        config.arithmetic = arithmetic;
        config.full_map = full_map;
        config.relocalising.on = relocalising;
        config.use = Use::close_loops;
        config.exclude = 30;
        PlaceMap map(config, {180, 40});
        Detector detector(config, map);
        std::size_t matched = 0;
        const AllocationGuard guard;
        for (int repeat = 0; repeat < 3; ++repeat) {
          for (const auto& descriptor : lap) {
            matched += matches(detector.step(descriptor));
          }
          matched += matches(detector.step({}));
          detector.skip(7);
        }
        EXPECT_EQ(guard.count(), 0U);
        EXPECT_GT(matched, 100U);
        EXPECT_FALSE(map.order().straight());
      }
    }
  }
}

TEST_F(NoAllocation, InRemovingComponents) {
  std::vector<std::uint8_t> pictures(10'000);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    pictures[i] = static_cast<std::uint8_t>(i * i * 31 >> 5U);
  PrincipalComponents components(pictures, 1000, 5);
  ASSERT_EQ(components.count(), 5U);
  const AllocationGuard guard;
  components.remove(std::span(pictures).first(1000), std::span(pictures).first(1000));
  EXPECT_EQ(guard.count(), 0U);
}

TEST_F(NoAllocation, WhereVisitsOfAReferenceAreLookedFor) {
  const oracle::Vectors lap = test::way(1, 150, 0.3F, 1);
  const MatcherConfig config;
  PlaceMap map(config, {2 * lap.size(), lap.front().size()});
  for (const auto& place : lap) static_cast<void>(map.learn(place));
  VisitFinder visits(config, map, map.capacity());
  const AllocationGuard guard;
  for (int i = 0; i < 2; ++i) {
    for (const auto& place : lap) {
      EXPECT_TRUE(map.add(place));
      visits.take(place);
    }
  }
  visits.link(map);
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_TRUE(map.same_place(75, 225));
}

}  // namespace
}  // namespace seqloop
