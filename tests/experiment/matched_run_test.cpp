// SPDX-License-Identifier: MIT
#include "experiment/run/matched_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "program/drives/match_drive.hpp"
#include "synthetic/places.hpp"

namespace seqloop::experiment {
namespace {

constexpr std::size_t places = 5000;

/// A street, and a drive that is carried elsewhere in it now and then.
DescribedPair street() {
  constexpr double apart = 8.0;  // so far that no frame is left out as like the one before
  constexpr std::size_t size = 16;
  program::SyntheticPlaces seen(size);
  const auto drive = [&](const std::vector<std::size_t>& positions, float noise) {
    files::Matrix rows{positions.size(), size, std::vector<float>(positions.size() * size)};
    for (std::size_t i = 0; i < positions.size(); ++i) {
      seen.see(apart * static_cast<double>(positions[i]), noise,
               std::span(rows.values).subspan(i * size, size));
    }
    return rows;
  };
  std::vector<std::size_t> all;
  for (std::size_t place = 0; place < places; ++place) all.push_back(place);
  std::vector<std::size_t> driven;
  for (const std::size_t begin : {3000U, 4900U, 400U}) {
    for (std::size_t i = 0; i < 40; ++i) driven.push_back(begin + i);
  }
  return {drive(all, 0.0F), drive(driven, 0.5F), {driven.size()}};
}

using Told = std::vector<std::tuple<std::uint64_t, std::uint64_t, double, double, bool>>;

/// What `seqloop match` writes where a frame looks at so many places.
Told as_match_does(MatcherConfig config, DescribedPair pair, std::size_t slice) {
  config.relocalising.rows_scanned = slice;
  Told told;
  const auto matched = program::match_drive(config, std::move(pair.reference), pair.query, {});
  for (const program::MatchedFrame& frame : matched.frames) {
    const Answer& answer = frame.answer;
    told.emplace_back(answer.frame, answer.match->frame(),
                      static_cast<double>(answer.match->uniqueness),
                      static_cast<double>(answer.probability), answer.gate == Gate::match);
  }
  return told;
}

Told as_experiments_do(const RunSpec& run, DescribedPair pair) {
  Told told;
  for (const evaluation::Answer& answer : match_pair(run, std::move(pair), false).answers) {
    told.emplace_back(answer.query, answer.match, answer.uncertainty, answer.probability,
                      answer.accepted == true);
  }
  std::ranges::sort(told);
  return told;
}

TEST(MatchedRun, AFrameLooksAtAsManyPlacesAsTheProgramsDoes) {
  Faults faults;
  const Experiment experiment = parse_experiment(R"(
[[drive]]
name = "street"
source = "street"
[[descriptor]]
name = "gradients"
[[pair]]
name = "again"
reference = "street"
query = "street"
[[method]]
name = "m"
method = "o-seqcnnslam"
descriptor = "gradients"
relocalise-s = [0.04, 0.2]
)",
                                                 "e.toml", {}, faults);
  ASSERT_TRUE(faults.empty()) << faults.front().why;
  ASSERT_EQ(experiment.runs.size(), 2U);
  const DescribedPair pair = street();
  std::vector<Told> told;
  for (const RunSpec& run : experiment.runs) told.push_back(as_experiments_do(run, pair));
  const MatcherConfig& config = experiment.runs.front().config;
  EXPECT_EQ(told[0], as_match_does(config, pair, places)) << "all of them";
  EXPECT_EQ(told[1], as_match_does(config, pair, 4096)) << "the fewest";
  EXPECT_NE(told[0], told[1]) << "a drive on which it makes no difference";
}

TEST(MatchDrive, AsksWhetherToGoOnWhileTheMapIsFilled) {
  const DescribedPair pair = street();
  std::size_t asked = 0;
  bool stepped = false;
  const auto between = [&] { asked += stepped ? 0 : 1; };
  const auto report = [&](const FrameReport& /*report*/) { stepped = true; };
  (void)program::match_drive({}, pair.reference, pair.query, {nullptr, between, report});
  EXPECT_GE(asked, places / MatcherConfig::most_frames_at_once);
}

}  // namespace
}  // namespace seqloop::experiment
