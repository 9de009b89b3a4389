// SPDX-License-Identifier: MIT
#include "dds/frame_times.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace seqloop::dds {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t first = 1'700'000'000'123'456'789;
constexpr std::int64_t interval = 33'333'333;
constexpr Nanoseconds booted = std::chrono::hours(5);

/// A camera whose pictures arrive 4 ms after they were taken.
class FrameTimesTest : public ::testing::Test {
 protected:
  FrameTimes::Judged at(std::int64_t stamp_ns) {
    constexpr std::int64_t on_the_way = 4'000'000;
    now_ns_ = std::max(now_ns_, stamp_ns + on_the_way);
    return times_.judge(stamp_ns, booted + Nanoseconds(now_ns_ - first), now_ns_);
  }
  FrameTimes::Judged wait_and_judge(std::int64_t wait_ns, std::int64_t stamp_ns) {
    now_ns_ += wait_ns;
    return times_.judge(stamp_ns, booted + Nanoseconds(now_ns_ - first), now_ns_);
  }

  FrameTimes times_;
  std::int64_t now_ns_ = first;
};

TEST_F(FrameTimesTest, StampsAreExactAndAgesCountFromThem) {
  for (std::int64_t i = 0; i < 100'000; i += 777) {
    const FrameTimes::Judged judged = at(first + i * interval);
    EXPECT_EQ(times_.start_ns() + std::llround(judged.time_s * 1e9), first + i * interval);
    EXPECT_EQ(judged.stamp, booted + Nanoseconds(i * interval));
    EXPECT_TRUE(judged.remark.empty());
  }
}

TEST_F(FrameTimesTest, GapsAreLostFramesOnceTheRateIsKnown) {
  std::int64_t frame = 0;
  const auto lost = [&](std::int64_t frames_on) {
    frame += frames_on;
    return at(first + frame * interval + frame % 3 * 2'000'000).lost;
  };
  EXPECT_EQ(lost(0), 0U);
  EXPECT_EQ(lost(7), 0U) << "nobody knows the rate yet";
  for (int i = 0; i < 20; ++i) EXPECT_EQ(lost(1), 0U);
  EXPECT_EQ(lost(2), 1U);
  EXPECT_EQ(lost(1), 0U);
  EXPECT_NEAR(static_cast<double>(lost(31)), 30.0, 1.0) << "stamps shake by a tenth";
  EXPECT_NEAR(static_cast<double>(lost(1'000)), 999.0, 20.0);
  // Half the rate from here on: told as gaps for as long as most intervals known are the old ones.
  std::uint64_t sum = 0;
  for (int i = 0; i < 20; ++i) sum += lost(2);
  EXPECT_LE(sum, 5U) << "then the new one is known";
}

TEST_F(FrameTimesTest, WithoutAStampTheTimeOfArrivalCounts) {
  EXPECT_EQ(wait_and_judge(0, 0).remark, "the header has no stamp: the time of arrival is used");
  const FrameTimes::Judged second = wait_and_judge(interval, 0);
  EXPECT_NEAR(second.time_s, 0.033333333, 1e-12);
  EXPECT_EQ(second.stamp, booted + Nanoseconds(interval));
  EXPECT_TRUE(second.remark.empty()) << "told once";
  EXPECT_EQ(times_.start_ns(), first);
}

TEST_F(FrameTimesTest, AClockThatIsSetBackDoesNotSetTheDriveBack) {
  static_cast<void>(at(first));
  static_cast<void>(at(first + interval));
  const FrameTimes::Judged back = wait_and_judge(interval, first - 1'000'000'000);
  EXPECT_EQ(back.remark, "the header's stamp went back: the time of arrival is used");
  EXPECT_NEAR(back.time_s, 0.066666666, 1e-9);
  const FrameTimes::Judged next = wait_and_judge(interval, first - 1'000'000'000 + interval);
  EXPECT_NEAR(next.time_s, 0.099999999, 1e-9);
  EXPECT_EQ(times_.start_ns() + std::llround(next.time_s * 1e9), first - 1'000'000'000 + interval);
}

TEST_F(FrameTimesTest, StampsFromBeforeAClockWasSetBackStay) {
  // A simulation that begins again and again.
  struct Shown {
    std::int64_t time_ns;
    std::int64_t stamp_ns;
    std::size_t run;
  };
  constexpr std::size_t runs = Stamps::remembered + 10;
  std::vector<Shown> shown;
  for (std::size_t run = 0; run < runs; ++run) {
    for (std::int64_t i = 0; i < 50; ++i) {
      const std::int64_t stamp = 100'000'000 + i * interval;
      const double time_s = wait_and_judge(interval + 7, stamp).time_s;
      shown.push_back({std::llround(time_s * 1e9), stamp, run});
    }
  }
  for (const Shown& picture : shown) {
    const bool known = picture.run + Stamps::remembered >= runs;
    ASSERT_EQ(times_.stamp_ns(picture.time_ns), known ? picture.stamp_ns : 0) << picture.run;
  }
  EXPECT_EQ(FrameTimes().stamp_ns(5), 0) << "nothing has come";
}

TEST_F(FrameTimesTest, SimulatedTimeHasNoAge) {
  const FrameTimes::Judged simulated = wait_and_judge(0, 5'000'000'000);
  EXPECT_EQ(simulated.remark, "the header's stamp is of another clock: ages count from arrival");
  EXPECT_EQ(simulated.stamp, booted);
  EXPECT_NEAR(wait_and_judge(interval, 5'100'000'000).time_s, 0.1, 1e-12);
  for (const std::int64_t odd : {INT64_MIN, std::int64_t{-1}, INT64_MAX}) {
    static_cast<void>(wait_and_judge(interval, odd));
  }
}

}  // namespace
}  // namespace seqloop::dds
