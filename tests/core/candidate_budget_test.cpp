// SPDX-License-Identifier: MIT
// What is taken in is all there, and costs no more than it may.
#include "seqloop/detail/candidate_budget.hpp"

#include <random>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

/// What a budget is spent on, on a map to localise in.
class Budgeted {
 public:
  Budgeted(const MatcherConfig& config, std::size_t places)
      : config_(config),
        drive_(oracle::drive(3, places, 8)),
        map_(map_of(drive_, config)),
        trajectories_(memory_.arena, config.sequence_length, config.vmin, config.vmax),
        queries_(memory_.arena, DescriptorForm(config, 8), config.sequence_length + 1),
        slices_(memory_.arena, config, queries_, {places, 8}),
        budget_(memory_.arena, config) {}

  void next_frame() {
    queries_.push(drive_[static_cast<std::size_t>(queries_.frames()) % drive_.size()]);
    budget_.clear();
  }

  /// @param began the first frame that belongs together with the newest
  void add(CandidateRun range, std::uint64_t began = 0) {
    budget_.add({&slices_, &map_, &trajectories_, began, queries_.frames(), map_.size()}, range);
  }

  [[nodiscard]] std::size_t rows() const {
    std::size_t rows = 0;
    for (const CandidateRun run : budget_.runs()) rows += run.last - run.first;
    return rows;
  }

  void expect_within_limits_and_complete() const {
    EXPECT_LE(rows(), CandidateBudget::most_rows(config_));
    EXPECT_LE(budget_.distances(), distances_a_frame(config_));
    const auto places = static_cast<std::int64_t>(map_.size());
    const std::uint64_t window = config_.sequence_length + 1;
    for (const CandidateRun run : budget_.runs()) {
      for (std::size_t i = 0; i < window; ++i) {
        if (queries_.frames() + i < window) continue;
        for (std::size_t line = 0; line < trajectories_.count(); ++line) {
          for (std::size_t row = run.first; row < run.last; ++row) {
            const std::int64_t at = static_cast<std::int64_t>(row) + trajectories_.offsets(line)[i];
            if (at < 0 || at >= places) continue;
            const auto cell = static_cast<std::size_t>(at);
            ASSERT_EQ(slices_.missing(map_, queries_.frames() + i - window, cell, cell + 1), 0U)
                << "row " << row << ", column " << i;
          }
        }
      }
    }
  }

  [[nodiscard]] const CandidateBudget& budget() const { return budget_; }

 private:
  MatcherConfig config_;
  oracle::Vectors drive_;
  PlaceMap map_;
  TestArena memory_;
  Trajectories trajectories_;
  QueryHistory queries_;
  DifferenceSlices slices_;
  CandidateBudget budget_;
};

MatcherConfig relocalising(std::size_t ds) {
  MatcherConfig config = paper(Candidates::ranges, ds);
  config.relocalising.on = true;
  return config;
}

TEST(CandidateBudget, AreCompleteAndWithinTheLimits) {
  std::size_t rows = 0;
  for (const std::size_t ds : {0U, 1U, 6U, 20U}) {
    for (const double vmax : {1.0, 1.2, 3.0}) {
      for (const bool enhance : {false, true}) {
        MatcherConfig config = relocalising(ds);
        config.vmin = 2.0 - std::min(vmax, 2.0);
        config.vmax = vmax;
        config.num = 9;
        config.enhance = enhance;
        config.relocalising.distances = 10 + 3 * ds + 10 + 7;
        ASSERT_TRUE(validate(config).empty());
        Budgeted budgeted(config, 150);
        std::mt19937 random(static_cast<std::uint32_t>(ds) + 5);
        for (int frame = 0; frame < 120; ++frame) {
          budgeted.next_frame();
          for (int range = 0; range < 8; ++range) {
            const std::size_t first = random() % 150;
            budgeted.add({first, std::min<std::size_t>(150, first + 1 + random() % 25)});
          }
          budgeted.expect_within_limits_and_complete();
          if (HasFatalFailure()) return;
          rows += budgeted.rows();
        }
      }
    }
  }
  EXPECT_GT(rows, 5'000U);
}

// The least that may be configured lets one range keep up with the robot, once it is there.
TEST(CandidateBudget, TheLeastThatMayBeSpentKeepsUpWithOneRange) {
  for (const bool enhance : {false, true}) {
    for (const std::size_t ds : {0U, 5U, 20U, 60U}) {
      MatcherConfig config = relocalising(ds);
      config.enhance = enhance;
      const std::size_t spread = static_cast<std::size_t>(std::ceil(0.4 * static_cast<double>(ds)));
      config.relocalising.distances = config.num + 1 + spread + (enhance ? config.rwindow : 0);
      ASSERT_TRUE(validate(config).empty());
      Budgeted budgeted(config, 500);
      std::size_t last = 0;
      for (std::size_t frame = 0; frame < 400; ++frame) {
        budgeted.next_frame();
        const std::size_t row = frame + 50;
        budgeted.add({row - config.num / 2, row + config.num / 2 + 1});
        budgeted.expect_within_limits_and_complete();
        if (HasFatalFailure()) return;
        last = budgeted.rows();
      }
      EXPECT_EQ(last, config.num + 1) << "ds " << ds << ", enhance " << enhance;
    }
  }
}

TEST(CandidateBudget, WhatOneFrameBeginsTheNextOnesFinish) {
  MatcherConfig config = relocalising(20);
  Budgeted budgeted(config, 500);
  for (int frame = 0; frame < 100; ++frame) budgeted.next_frame();
  std::size_t frames = 0;
  do {
    budgeted.next_frame();
    const std::size_t row = 200 + frames;
    budgeted.add({row - 8, row + 9});
    ++frames;
  } while (budgeted.rows() < 17 && frames < 50);
  EXPECT_LE(frames, 3U);
}

TEST(CandidateBudget, WithoutRelocalisingNothingIsTurnedAway) {
  MatcherConfig config = paper(Candidates::ranges, 20);
  Budgeted budgeted(config, 500);
  for (int frame = 0; frame < 21; ++frame) budgeted.next_frame();
  budgeted.add({0, 500});
  EXPECT_EQ(budgeted.rows(), 500U);
}

}  // namespace
}  // namespace seqloop
