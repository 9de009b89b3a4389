// SPDX-License-Identifier: MIT
#include "ros/time.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "ros/cdr.hpp"

namespace seqloop::ros {
namespace {

std::int64_t written(std::int64_t time_ns) {
  CdrWriter cdr;
  cdr.time(time_ns);
  cdr.text("");
  return CdrReader(cdr.bytes()).stamp();
}

TEST(Time, IsOneThatSubscribersTake) {
  constexpr std::int64_t last = 2'147'483'647'999'999'999;
  for (const std::int64_t good : {std::int64_t{0}, std::int64_t{1'700'000'000'123'456'789}, last}) {
    EXPECT_EQ(written(good), good);
  }
  for (const std::int64_t before :
       {std::int64_t{-1}, -last, std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_EQ(written(before), 0) << before;
  }
  for (const std::int64_t beyond : {last + 1, std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_EQ(written(beyond), last) << beyond;
  }
  EXPECT_EQ(time_of(last).nanosec, 999'999'999U);
}

}  // namespace
}  // namespace seqloop::ros
