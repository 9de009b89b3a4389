// SPDX-License-Identifier: MIT
#include "seqloop/budget.hpp"

#include <gtest/gtest.h>

namespace seqloop {
namespace {

using std::chrono::milliseconds;

TEST(Budget, NamesTheLimitsThatAFrameBroke) {
  StageTimes times;
  times.age = milliseconds(30);
  times.grab = milliseconds(2);
  times.describe = milliseconds(20);
  times.match = milliseconds(3);
  times.total = milliseconds(25);
  Budget budget;
  EXPECT_FALSE(misses(times, budget).any());
  budget.total = milliseconds(25);
  EXPECT_FALSE(misses(times, budget).any()) << "what takes just as long as it may is in time";
  budget.total = milliseconds(24);
  budget.describe = milliseconds(19);
  const Misses missed = misses(times, budget);
  EXPECT_TRUE(missed.total && missed.describe);
  EXPECT_FALSE(missed.age || missed.grab || missed.match) << "zero is no limit";
  budget = {.total = {}, .age = milliseconds(29), .grab = milliseconds(1)};
  EXPECT_TRUE(misses(times, budget).age && misses(times, budget).grab);
  EXPECT_FALSE(misses(times, budget).total);
}

TEST(OverloadWatch, BeginsAfterMissesInARowOnly) {
  OverloadWatch watch({.after = 3, .recover = 4});
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(watch.observe(true));
    EXPECT_FALSE(watch.observe(true));
    EXPECT_FALSE(watch.observe(false));
  }
  EXPECT_FALSE(watch.overloaded());
  EXPECT_FALSE(watch.observe(true));
  EXPECT_FALSE(watch.observe(true));
  EXPECT_TRUE(watch.observe(true)) << "it begins here";
  EXPECT_TRUE(watch.overloaded());
  EXPECT_FALSE(watch.observe(true)) << "and goes on";
  EXPECT_EQ(watch.episodes(), 1U);
}

TEST(OverloadWatch, EndsByItself) {
  OverloadWatch watch({.policy = OverloadPolicy::every_nth, .every = 3, .after = 1, .recover = 2});
  EXPECT_EQ(watch.take_every(), 1U);
  EXPECT_TRUE(watch.observe(true));
  EXPECT_EQ(watch.take_every(), 3U);
  EXPECT_FALSE(watch.observe(false));
  EXPECT_FALSE(watch.observe(true)) << "the count begins anew";
  EXPECT_FALSE(watch.observe(false));
  EXPECT_TRUE(watch.observe(false));
  EXPECT_EQ(watch.take_every(), 1U);
  EXPECT_TRUE(watch.observe(true));
  EXPECT_EQ(watch.episodes(), 2U);
}

TEST(OverloadWatch, TakesWhatIsTooLittleForTheLeast) {
  OverloadWatch watch({.policy = OverloadPolicy::every_nth, .every = 0, .after = 0, .recover = 0});
  EXPECT_FALSE(watch.observe(false)) << "nothing was missed";
  EXPECT_TRUE(watch.observe(true));
  EXPECT_EQ(watch.take_every(), 2U);
  EXPECT_FALSE(watch.observe(true));
  EXPECT_TRUE(watch.observe(false));
  EXPECT_EQ(watch.take_every(), 1U);
}

TEST(OverloadWatch, ThinsOutOnlyWhereThatIsThePolicy) {
  OverloadWatch watch({.after = 1});
  EXPECT_TRUE(watch.observe(true));
  EXPECT_EQ(watch.take_every(), 1U);
}

}  // namespace
}  // namespace seqloop
