// SPDX-License-Identifier: MIT
// A map of a million places: its memory is what the plan says, and no step takes more work, memory
// or pages than in a small one.
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "core/allocation_guard.hpp"
#include "core/matcher.hpp"
#include "resident_memory.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

constexpr std::size_t places = 1'000'000;
constexpr std::size_t descriptor_size = 735;
constexpr std::uint32_t seed = 11;

// The robot drives along the first stretch, then is carried to the second one.
constexpr std::size_t frames = 1000;
constexpr std::array<std::size_t, 2> stretches{250'000, 900'000};

double resident_bytes() { return static_cast<double>(test::resident_bytes()); }

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

/// Directions that drift, so that neighbours look alike; one after the other, or a million of them
/// would take more memory than the map.
class Walk {
 public:
  std::vector<float> next() {
    for (std::size_t i = 0; i < descriptor_size; ++i) {
      constexpr auto middle = static_cast<float>(std::mt19937::max() / 2);
      place_[i] = 0.8F * place_[i] + static_cast<float>(random_()) / middle - 1.0F;
    }
    std::vector<float> unit = place_;
    normalise(unit);
    return unit;
  }

 private:
  std::mt19937 random_{seed};
  std::vector<float> place_ = std::vector<float>(descriptor_size, 0.0F);
};

struct SyntheticMap {
  SyntheticMap() {
    Walk walk;
    for (std::size_t row = 0; row < places; ++row) {
      const std::vector<float> place = walk.next();
      ok = map.add(place) && ok;
      for (const std::size_t first : stretches) {
        if (row >= first && row < first + frames) query[query_size++] = place;
      }
    }
  }

  static MatcherConfig config() {
    MatcherConfig config;
    config.standardisation.on = false;
    return config;
  }

  oracle::Vectors query =
      oracle::Vectors(stretches.size() * frames, std::vector<float>(descriptor_size, 1.0F));
  std::size_t query_size = 0;
  double before = resident_bytes();
  PlaceMap map{config(), {places, descriptor_size}};
  bool ok = true;
};

TEST(MillionPlaces, TakeWhatThePlanSaysAndNoStepMoreThanInASmallMap) {
  if (!AllocationGuard::works()) GTEST_SKIP() << "a sanitizer's heap cannot be counted";
  const MatcherConfig config = SyntheticMap::config();
  const Capacity capacity{places, descriptor_size};
  const auto planned = static_cast<double>(PlaceMap::bytes_needed(config, capacity) +
                                           Detector::bytes_needed(config, capacity));
  const long faults_before_all = page_faults();
  SyntheticMap drive;
  ASSERT_TRUE(drive.ok);
  EXPECT_GT(page_faults(), faults_before_all) << "what counts them can count";
  Detector detector(config, drive.map);
  const double built = resident_bytes() - drive.before;

  const Work most = Detector::most_work(config, capacity);
  EXPECT_EQ(most, Detector::most_work(config, {20'000, descriptor_size}));
  std::array<std::size_t, stretches.size()> found{};
  const auto count = [&found](std::span<const Answer> answers) {
    for (const Answer& answer : answers) {
      if (answer.gate != Gate::match) continue;
      const auto frame = static_cast<std::size_t>(answer.frame);
      const std::size_t right = stretches[frame / frames] + frame % frames;
      found[frame / frames] += answer.match->place == right;
    }
  };
  std::size_t allocations = 0;
  long faults = 0;
  for (std::size_t frame = 0; frame < drive.query.size(); ++frame) {
    const long faults_before = page_faults();
    const AllocationGuard guard;
    const FrameReport report = detector.step(drive.query[frame]);
    allocations += guard.count();
    faults += page_faults() - faults_before;
    EXPECT_LE(report.work.candidates, most.candidates) << frame;
    EXPECT_LE(report.work.distances, most.distances) << frame;
    EXPECT_LE(report.work.line_sums, most.line_sums) << frame;
    EXPECT_LE(report.work.sketches, most.sketches) << frame;
    count(report.answers);
  }
  count(detector.finish());
  const double stepped = resident_bytes() - drive.before;
  std::printf(
      "seed %u: planned %.0f bytes, grown by %.0f when built, %.0f after %zu steps; faults %ld, "
      "allocations %zu; right %zu and %zu of %zu\n",
      seed, planned, built, stepped, drive.query.size(), faults, allocations, found[0], found[1],
      frames);
  EXPECT_NEAR(stepped, planned, 0.05 * planned);
  EXPECT_EQ(allocations, 0U);
  // The kernel takes a page away now and then; a step that takes memory would do so each time.
  EXPECT_LT(faults, static_cast<long>(frames / 100));
  // The whole map has been scanned once after this many frames.
  const std::size_t round = places / config.relocalising.rows_scanned + 1;
  for (const std::size_t right : found) {
    EXPECT_GE(right, frames - round - 3 * config.sequence_length);
  }
}

}  // namespace
}  // namespace seqloop
