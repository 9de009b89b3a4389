// SPDX-License-Identifier: MIT
// Work stays within the plan whatever happens, and a partial search never makes up a score.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/chance.hpp"
#include "core/matcher.hpp"
#include "core/shown_drive.hpp"

namespace seqloop {
namespace {

struct Drive {
  MatcherConfig config;
  std::size_t places;
};

Drive any_drive(Chance& chance) {
  MatcherConfig config;
  config.decision = Decision::uniqueness;
  config.candidates = chance.one_of({Candidates::all, Candidates::ranges, Candidates::adaptive});
  config.use = chance.one_of({Use::localise, Use::close_loops});
  config.arithmetic = chance.one_of({Arithmetic::float32, Arithmetic::int8, Arithmetic::sketch});
  config.sequence_length = chance.one_of<std::size_t>({0, 1, 2, 5, 12, 20, 41});
  const auto [vmin, vmax] =
      chance.one_of<std::pair<double, double>>({{0.8, 1.2}, {0.0, 2.0}, {1.0, 1.0}, {0.5, 3.0}});
  config.vmin = vmin;
  config.vmax = vmax;
  config.rwindow = chance.between(0, 20);
  config.k = chance.between(1, 12);
  config.initial_k = chance.between(1, 30);
  config.num = chance.between(1, 40);
  config.exclude = chance.between(1, 40);
  config.full_map = chance.one_of({FullMap::refuse, FullMap::forget_oldest, FullMap::thin});
  config.enhance = chance.one_in(4) && config.full_map == FullMap::refuse && config.rwindow > 1 &&
                   config.exclude > config.rwindow / 2;
  config.relocalising.rows_scanned = chance.one_of<std::size_t>({2, 7, 64, 4096});
  if (chance.one_in(2)) {
    const auto spread = static_cast<std::size_t>(
        std::ceil((vmax - vmin) * static_cast<double>(config.sequence_length)));
    config.relocalising.distances = config.num + 1 + spread + chance.between(0, 50) +
                                    (config.enhance ? config.rwindow / 2 * 2 : 0);
  }
  config.standardisation.on = chance.one_in(4);
  config.blank_is_unreadable = chance.one_in(2);
  config.max_uniqueness = 1.0F;
  const bool places_go = config.use == Use::close_loops && config.full_map != FullMap::refuse;
  return {config, chance.between(places_go ? least_places(config) : 1, 250)};
}

std::string text(const Drive& drive, std::uint32_t seed) {
  const MatcherConfig& c = drive.config;
  std::ostringstream out;
  out << "seed " << seed << ", candidates " << static_cast<int>(c.candidates) << ", use "
      << static_cast<int>(c.use) << ", arithmetic " << static_cast<int>(c.arithmetic) << ", full "
      << static_cast<int>(c.full_map) << ", ds " << c.sequence_length << ", v " << c.vmin << ".."
      << c.vmax << ", num " << c.num << ", exclude " << c.exclude << ", enhance " << c.enhance
      << ", rwindow " << c.rwindow << ", rows scanned " << c.relocalising.rows_scanned
      << ", distances " << c.relocalising.distances << ", standardised " << c.standardisation.on
      << ", places " << drive.places;
  return out.str();
}

/// Two laps of the same way; here and there nothing to see, and jumps.
oracle::Vectors laps(std::uint32_t seed) {
  oracle::Vectors laps = oracle::drive(seed, 170, 16, 0.2F);
  const oracle::Vectors again = oracle::drive(seed, 170, 16, 0.3F);
  laps.insert(laps.end(), again.begin(), again.end());
  return laps;
}

void expect_within(const Work& work, const Work& most) {
  EXPECT_LE(work.candidates, most.candidates);
  EXPECT_LE(work.distances, most.distances);
  EXPECT_LE(work.line_sums, most.line_sums);
  EXPECT_LE(work.scanned, most.scanned);
  EXPECT_LE(work.sketches, most.sketches);
}

/// The answer is what its row scores by definition; where all rows were searched, it is the best.
void expect_true(const FrameReport& report, const oracle::ShownDrive& shown,
                 const MatcherConfig& config) {
  const bool all = config.candidates == Candidates::all;
  if (report.match) {
    const auto row = shown.row_of(report.match->place);
    ASSERT_TRUE(row);
    const auto scored = shown.score(*row);
    ASSERT_TRUE(scored);
    if (config.arithmetic == Arithmetic::float32) {
      EXPECT_NEAR(report.match->score, scored->score, 1e-5);
    } else {
      EXPECT_EQ(report.match->score, static_cast<float>(scored->score));
      EXPECT_EQ(report.match->head, shown.number(scored->head));
    }
  }
  if (!all || !shown.whole() || report.gate == Gate::frame_error) return;
  std::size_t scored = 0;
  double best = std::numeric_limits<double>::infinity();
  for (std::int64_t row = 0; row < shown.rows(); ++row) {
    const auto score = shown.score(row);
    if (!score) continue;
    ++scored;
    best = std::min(best, score->score);
  }
  EXPECT_EQ(report.work.candidates, scored);
  ASSERT_EQ(report.match.has_value(), scored > 0);
  if (report.match) {
    EXPECT_NEAR(report.match->score, best, 1e-5);
  }
}

/// @return answers
std::size_t play(std::uint32_t seed) {
  Chance chance(seed);
  const Drive drive = any_drive(chance);
  const MatcherConfig& config = drive.config;
  SCOPED_TRACE(text(drive, seed));
  EXPECT_TRUE(validate(config).empty());
  const oracle::Vectors frames = laps(seed);
  const oracle::Vectors places = oracle::drive(seed, drive.places, 16, 0.25F);
  const bool closing = config.use == Use::close_loops;
  PlaceMap map = closing ? PlaceMap(config, {drive.places, 16}) : map_of(places, config);
  Detector detector(config, map);
  const Work most = Detector::most_work(config, {drive.places, 16});
  oracle::ShownDrive shown(config, map, closing ? oracle::Vectors{} : places);
  std::size_t answers = 0;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    SCOPED_TRACE(frame);
    std::vector<float> seen = frames[frame];
    if (chance.one_in(20)) seen.assign(chance.one_of<std::size_t>({0, 15, 16}), 0.0F);
    const bool blank = seen.size() == 16 && seen == std::vector<float>(16, 0.0F);
    const bool unreadable = seen.size() != 16 || (blank && config.blank_is_unreadable);
    const FrameReport report = detector.step(seen);
    shown.step(unreadable ? std::vector<float>{} : seen);
    EXPECT_EQ(report.gate == Gate::frame_error, unreadable);
    expect_within(report.work, most);
    if (!config.standardisation.on && !config.enhance) expect_true(report, shown, config);
    if (testing::Test::HasFailure()) return 0;
    if (report.match) ++answers;
    if (!chance.one_in(25)) continue;
    const std::size_t gap = chance.one_of<std::size_t>({1, 3, 20, 100});
    detector.skip(gap);
    shown.skip(gap);
    frame += gap;
  }
  return answers;
}

TEST(BoundedWork, StaysWithinThePlanAndNeverMakesUpAScore) {
  std::size_t answers = 0;
  for (std::uint32_t seed = 1; seed <= 200; ++seed) answers += play(seed);
  EXPECT_GT(answers, 15'000U);
}

std::size_t median(std::vector<std::size_t> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

TEST(BoundedWork, NoFrameCostsMuchMoreThanAnother) {
  const oracle::Vectors reference = oracle::drive(7, 3'000, 32, 0.2F);
  const oracle::Vectors query = oracle::drive(7, 3'000, 32, 0.5F);
  for (const Candidates candidates : {Candidates::ranges, Candidates::adaptive}) {
    for (const std::size_t scanned : {500U, 4096U}) {
      MatcherConfig config;
      config.candidates = candidates;
      config.relocalising.rows_scanned = scanned;
      PlaceMap map = map_of(reference, config);
      Detector detector(config, map);
      std::array<std::vector<std::size_t>, 4> counts;
      for (std::size_t frame = 1'000; frame < 2'500; ++frame) {
        const Work work = detector.step(query[frame]).work;
        if (frame < 1'000 + 2 * config.sequence_length) continue;
        const std::array counted{work.candidates, work.distances, work.line_sums, work.sketches};
        for (std::size_t i = 0; i < counts.size(); ++i) {
          counts[i].push_back(static_cast<std::size_t>(counted[i]));
        }
      }
      for (const std::vector<std::size_t>& count : counts) {
        const std::size_t most = *std::ranges::max_element(count);
        std::printf("method %d, rows scanned %zu: median %zu, most %zu\n",
                    static_cast<int>(candidates), scanned, median(count), most);
        EXPECT_LE(most, 3 * median(count));
      }
    }
  }
}

}  // namespace
}  // namespace seqloop
