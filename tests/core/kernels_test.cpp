// Each kernel beside its definition.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/matcher.hpp"
#include "seqloop/detail/contrast.hpp"
#include "seqloop/detail/trajectories.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/latency_histogram.hpp"

namespace seqloop {
namespace {

TEST(Euclidean, EqualsTheDefinitionForEveryLength) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  for (const std::size_t size : {0U, 16U, 32U, 48U, 1024U, 1040U, 9216U}) {
    std::vector<float> a(size);
    std::vector<float> b(size);
    double sum = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      a[i] = normal(random);
      b[i] = normal(random);
      sum += (static_cast<double>(a[i]) - static_cast<double>(b[i])) *
             (static_cast<double>(a[i]) - static_cast<double>(b[i]));
    }
    EXPECT_NEAR(euclidean(a, b), std::sqrt(sum), 1e-5 * (1.0 + std::sqrt(sum))) << size;
    EXPECT_EQ(euclidean(a, a), 0.0F) << "equal vectors must not differ by rounding";
  }
}

TEST(MeanAbsolute, EqualsTheDefinitionWithoutThePadding) {
  std::mt19937 random(12);
  std::normal_distribution<float> normal;
  for (const std::size_t size : {1U, 15U, 16U, 17U, 1024U, 1025U, 2048U}) {
    std::vector<float> a(padded_size(size), 0.0F);
    std::vector<float> b(padded_size(size), 0.0F);
    double sum = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      a[i] = normal(random);
      b[i] = normal(random);
      sum += std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    }
    EXPECT_NEAR(mean_absolute(a, b, size), sum / static_cast<double>(size), 1e-5) << size;
    EXPECT_EQ(mean_absolute(a, a, size), 0.0F);
  }
}

TEST(Blank, IsZeroForVectorsAndFlatForPatches) {
  const std::vector<float> zero(4, 0.0F);
  const std::vector<float> flat(4, 127.5F);
  const std::vector<float> seen{127.5F, 127.5F, 127.5F, 128.0F};
  EXPECT_TRUE(blank(Difference::euclidean, zero));
  EXPECT_TRUE(blank(Difference::mean_absolute, zero));
  EXPECT_FALSE(blank(Difference::euclidean, flat));
  EXPECT_TRUE(blank(Difference::mean_absolute, flat));
  EXPECT_FALSE(blank(Difference::mean_absolute, seen));
  EXPECT_FALSE(blank(Difference::mean_absolute,
                     std::vector<float>(3, std::numeric_limits<float>::quiet_NaN())));
}

TEST(Contrast, EnhancesByHandAndIsNeverNegative) {
  // Rows 1, 2, 6 have mean 3 and sample deviation sqrt(7); the constant is 2 / sqrt(3).
  const Contrast contrast(2);
  EXPECT_EQ(contrast.reach(), 1U);
  const std::vector<float> column{1.0F, 2.0F, 6.0F, 6.0F, 6.0F};
  const double lift = 2.0 / std::sqrt(3.0);
  EXPECT_NEAR(contrast.enhance(column, 1, 1.0), lift - 1.0 / std::sqrt(7.0), 1e-6);
  EXPECT_NEAR(contrast.enhance(column, 0, 1.0), lift - std::sqrt(0.5), 1e-6)
      << "clipped to two rows";
  EXPECT_NEAR(contrast.enhance(column, 3, 1.0), lift, 1e-6) << "nothing deviates";
  EXPECT_NEAR(contrast.enhance(std::span(column).first(3), 2, 1.0), lift + std::sqrt(0.5), 1e-6)
      << "the map ends here";
  EXPECT_NEAR(contrast.enhance(std::span(column).first(1), 0, 1.0), lift, 1e-6) << "a single row";
  // The lowest that a sample can lie below its mean: one lower, all others equal.
  for (const std::size_t rwindow : {2U, 3U, 10U, 50U}) {
    const Contrast wide(rwindow);
    std::vector<float> dip(2 * wide.reach() + 1, 1.7F);
    dip[wide.reach()] = 0.1F;
    const float lowest = wide.enhance(dip, wide.reach(), 1.0);
    EXPECT_GE(lowest, 0.0F);
    EXPECT_NEAR(lowest, 0.0F, 1e-6);
  }
}

TEST(PaddedSize, IsTheNextWholeNumberOfLanes) {
  EXPECT_EQ(padded_size(0), 0U);
  EXPECT_EQ(padded_size(1), 16U);
  EXPECT_EQ(padded_size(16), 16U);
  EXPECT_EQ(padded_size(17), 32U);
}

TEST(Normalise, MakesUnitVectorsAndLeavesZeroAlone) {
  std::vector<float> vector{3.0F, 0.0F, -4.0F};
  EXPECT_TRUE(normalise(vector));
  EXPECT_EQ(vector, (std::vector<float>{0.6F, 0.0F, -0.8F}));
  std::vector<float> zero(5, 0.0F);
  EXPECT_FALSE(normalise(zero));
  EXPECT_EQ(zero, std::vector<float>(5, 0.0F));
  std::vector<float> tiny{1e-30F, 0.0F};
  EXPECT_TRUE(normalise(tiny));
  EXPECT_FLOAT_EQ(tiny[0], 1.0F);
}

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

TEST(RunningStatistics, EqualTheBatchDefinition) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 3);
  std::mt19937 random(5);
  std::normal_distribution<float> normal(2.0F, 3.0F);
  std::vector<std::vector<float>> frames;
  for (int i = 0; i < 200; ++i) {
    frames.push_back({normal(random), normal(random), 7.0F});
    statistics.observe(frames.back());
  }
  for (std::size_t d = 0; d < 3; ++d) {
    double mean = 0.0;
    double variance = 0.0;
    for (const auto& frame : frames) mean += static_cast<double>(frame[d]) / 200.0;
    for (const auto& frame : frames)
      variance += std::pow(static_cast<double>(frame[d]) - mean, 2.0) / 200.0;
    EXPECT_NEAR(statistics.mean()[d], mean, 1e-9);
    EXPECT_NEAR(statistics.variance()[d], variance, 1e-9);
  }
  std::vector<float> out(3);
  EXPECT_TRUE(statistics.standardise(frames[0], out));
  EXPECT_EQ(out[2], 0.0F) << "a feature that never changes says nothing";
  EXPECT_NEAR(std::hypot(out[0], out[1]), 1.0, 1e-6);
}

TEST(RunningStatistics, StandardiseEqualsTheDefinitionForEverySize) {
  std::mt19937 random(6);
  std::normal_distribution<float> normal;
  for (const std::size_t size : {1U, 7U, 8U, 9U, 735U}) {
    TestArena memory;
    RunningStatistics statistics(memory.arena, size);
    std::vector<float> frame(size);
    for (int i = 0; i < 20; ++i) {
      // Features of very different deviations, some below the floor.
      for (std::size_t d = 0; d < size; ++d) {
        frame[d] = 3.0F + normal(random) / static_cast<float>(d + 1);
      }
      statistics.observe(frame);
    }
    double floor = 0.0;
    for (const double variance : statistics.variance()) floor += 0.1 * std::sqrt(variance);
    floor /= static_cast<double>(size);
    std::vector<double> right(size);
    double squares = 0.0;
    for (std::size_t d = 0; d < size; ++d) {
      right[d] = (static_cast<double>(frame[d]) - statistics.mean()[d]) /
                 std::max(std::sqrt(statistics.variance()[d]), floor);
      squares += right[d] * right[d];
    }
    std::vector<float> out(size);
    EXPECT_TRUE(statistics.standardise(frame, out));
    for (std::size_t d = 0; d < size; ++d) {
      const double value = right[d] / std::sqrt(squares);
      EXPECT_NEAR(static_cast<double>(out[d]), value, 3e-7 * std::abs(value)) << size << ' ' << d;
    }
  }
}

TEST(RunningStatistics, FirstFrameBecomesTheZeroVector) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 2);
  const std::vector<float> frame{1.0F, 2.0F};
  statistics.observe(frame);
  std::vector<float> out{9.0F, 9.0F};
  EXPECT_FALSE(statistics.standardise(frame, out));
  EXPECT_EQ(out, (std::vector<float>{0.0F, 0.0F}));
}

TEST(RunningStatistics, StartFromAnotherDriveAndMoveOn) {
  TestArena memory;
  RunningStatistics map(memory.arena, 1);
  for (const float value : {1.0F, 3.0F, 1.0F, 3.0F}) map.observe(std::vector<float>{value});
  RunningStatistics query(memory.arena, 1);
  query.start_from(map, 2);
  EXPECT_EQ(query.frames(), 2U);
  EXPECT_EQ(query.mean()[0], 2.0);
  query.follow(std::vector<float>{5.0F}, 100);
  EXPECT_DOUBLE_EQ(query.mean()[0], 3.0) << "one frame against a prior of two";
  EXPECT_DOUBLE_EQ(query.variance()[0], (2.0 / 3.0) * (1.0 + 9.0 / 3.0));
  query.start_from(map, 99);
  EXPECT_EQ(query.frames(), 4U) << "a prior counts for no more than what was seen";
}

TEST(RunningStatistics, ForgetBeyondTheHorizon) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 1);
  for (int i = 0; i < 1000; ++i) {
    statistics.follow(std::vector<float>{i % 2 == 0 ? -1.0F : 1.0F}, 10);
  }
  for (int i = 0; i < 100; ++i) {
    statistics.follow(std::vector<float>{i % 2 == 0 ? 8.0F : 12.0F}, 10);
  }
  EXPECT_NEAR(statistics.mean()[0], 10.0, 0.2);
}

TEST(RunningStatistics, AHaltTeachesThemNothing) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 2);
  for (int i = 0; i < 50; ++i) {
    statistics.follow(std::vector<float>{i % 2 == 0 ? -1.0F : 1.0F, i % 3 == 0 ? 2.0F : -1.0F}, 20);
  }
  statistics.follow(std::vector<float>{1.5F, 1.5F}, 20);
  const double before = statistics.mean()[0];
  for (int i = 0; i < 500; ++i) statistics.follow(std::vector<float>{1.5F, 1.51F}, 20);
  EXPECT_EQ(statistics.mean()[0], before);
}

TEST(RunningStatistics, StartFlatFromAFirstFrame) {
  TestArena memory;
  RunningStatistics statistics(memory.arena, 4);
  statistics.start_flat(std::vector<float>{1.0F, 1.0F, 3.0F, 3.0F}, 20);
  EXPECT_EQ(statistics.frames(), 20U);
  for (std::size_t d = 0; d < 4; ++d) {
    EXPECT_EQ(statistics.mean()[d], 2.0);
    EXPECT_EQ(statistics.variance()[d], 1.0);
  }
}

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

TEST(CandidateRanges, ClipUniteAndRankAsAlgorithmFourSays) {
  TestArena memory;
  MatcherConfig config;
  config.candidates = Candidates::ranges;
  config.relocalising.on = false;
  config.k = 3;
  config.num = 4;
  CandidateRanges ranges(memory.arena, config);
  CandidateRuns united(memory.arena, 3);
  const auto runs = [&](std::size_t rows) {
    united.clear();
    for (const CandidateRun range : ranges.choose(rows)) united.add(range);
    std::vector<std::pair<std::size_t, std::size_t>> all;
    for (const CandidateRun run : united.runs()) all.emplace_back(run.first, run.last);
    return all;
  };
  using Runs = std::vector<std::pair<std::size_t, std::size_t>>;
  constexpr double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(runs(20), (Runs{{0, 20}})) << "the first frame searches all";
  std::vector<double> scores(20, none);
  scores[0] = 0.3;
  scores[19] = 0.2;
  scores[10] = 0.1;
  scores[5] = 0.3;  // as good as row 0, but higher
  ranges.update(scores, united.runs(), 10, 1.0);
  EXPECT_EQ(runs(20), (Runs{{0, 3}, {8, 13}, {17, 20}})) << "clipped at both ends";
  std::ranges::fill(scores, none);
  scores[10] = 0.1;
  scores[12] = 0.2;
  ranges.update(scores, united.runs(), 10, 1.0);
  EXPECT_EQ(runs(20), (Runs{{8, 15}})) << "fewer rows than K, and they overlap";
  ranges.removed(11);
  EXPECT_EQ(runs(20), (Runs{{8, 14}})) << "the row behind the one that went is counted one lower";
  ranges.removed(0);
  EXPECT_EQ(runs(20), (Runs{{7, 13}}));
  ranges.skip(4);
  EXPECT_EQ(runs(20), (Runs{{11, 17}}));
  ranges.update(scores, united.runs(), std::nullopt, 1.0);
  EXPECT_EQ(runs(20), (Runs{{0, 20}})) << "after a frame without an answer";
  EXPECT_EQ(runs(0), Runs{}) << "an empty map";
}

TEST(LatencyHistogram, QuantilesAreWithinABucketOfTheSortedList) {
  std::mt19937_64 random(3);
  std::lognormal_distribution<double> durations(12.0, 3.0);
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5).count(), 0);
  std::vector<std::int64_t> all;
  for (int i = 0; i < 5000; ++i) {
    all.push_back(static_cast<std::int64_t>(durations(random)));
    histogram.add(Nanoseconds(all.back()));
  }
  std::sort(all.begin(), all.end());
  for (const double share : {0.001, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * 5000.0)) - 1;
    const auto exact = static_cast<double>(all[rank]);
    const auto given = static_cast<double>(histogram.quantile(share).count());
    EXPECT_GE(given, exact) << share;
    EXPECT_LE(given, exact * (1.0 + 1.0 / 32.0) + 1.0) << share;
  }
  EXPECT_EQ(histogram.maximum().count(), all.back());
}

TEST(LatencyHistogram, TakesTheLongestAndTheImpossible) {
  LatencyHistogram histogram;
  histogram.add(Nanoseconds::max());
  histogram.add(Nanoseconds(-5));
  EXPECT_EQ(histogram.quantile(1.0), Nanoseconds::max());
  EXPECT_EQ(histogram.quantile(0.5), Nanoseconds(0));
}

}  // namespace
}  // namespace seqloop
