// SPDX-License-Identifier: MIT
// No stage of a live run takes memory or faults a page in once it is warm. The pipeline asks its
// clock between its stages, so a clock that samples counters tells them apart.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstdlib>

#include "core/allocation_guard.hpp"
#include "core/matcher.hpp"
#include "platform/linux/live_rig.hpp"
#include "seqloop/linux/live_source.hpp"
#include "seqloop/linux/real_time.hpp"
#include "seqloop/linux/steady_clock.hpp"

namespace seqloop::live::test {
namespace {

constexpr std::uint64_t warm_up = 500;
constexpr std::uint64_t frames = 3000;
constexpr std::size_t map_size = 200;

struct Sample {
  std::size_t allocations = 0;
  std::uint64_t page_faults = 0;
};

class SamplingClock : public SteadyClock {
 public:
  Nanoseconds now() noexcept override {
    const ThreadCounters counters = thread_counters();
    if (taken_ < samples_.size()) {
      samples_[taken_++] = {guard_.count(), counters.minor_faults + counters.major_faults};
    }
    return SteadyClock::now();
  }

  /// What came in between the samples since the last call: one value a stage.
  template <typename Stage>
  void each_stage(Stage stage) {
    for (std::size_t i = 1; i < taken_; ++i) {
      stage(i - 1, samples_[i].allocations - samples_[i - 1].allocations,
            samples_[i].page_faults - samples_[i - 1].page_faults);
    }
    taken_ = 0;
  }

 private:
  AllocationGuard guard_;
  std::array<Sample, 16> samples_;
  std::size_t taken_ = 0;
};

/// Misbehaves when it is told to.
class GreedyDescriber : public FakeDescriber {
 public:
  using FakeDescriber::FakeDescriber;
  Description describe(const Image& image, std::span<float> descriptor) noexcept override {
    if (std::exchange(greedy, false)) {
      void* const volatile heap = std::malloc(32);
      std::free(heap);
      constexpr std::size_t bytes = 1U << 20U;
      void* const fresh =
          mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      if (fresh != MAP_FAILED) *static_cast<volatile char*>(fresh) = 1;
      munmap(fresh, bytes);
    }
    return FakeDescriber::describe(image, descriptor);
  }
  bool greedy = false;  // in the next call: one block of the heap, one page of the system
};

struct Found {
  std::uint64_t stages = 0;
  std::uint64_t allocations = 0;
  std::uint64_t page_faults = 0;
};

class LiveAllocation : public testing::TestWithParam<Candidates> {
 protected:
  void SetUp() override {
    if (!AllocationGuard::works()) GTEST_SKIP() << "a sanitizer's heap cannot be counted";
  }

  static Act act(std::uint64_t n) {
    return n % 50 == 7    ? Act::bad
           : n % 50 == 17 ? Act::undecodable
           : n % 50 == 27 ? Act::silent
                          : Act::frame;
  }

  /// A run, with what came in its stages after the warm-up.
  /// @param greedy whether the describer misbehaves once, in the middle of the run
  static Found run(Candidates candidates, Use use, bool greedy) {
    const oracle::Vectors drive = oracle::drive(5, map_size, 16);
    MatcherConfig config;
    config.candidates = candidates;
    config.use = use;
    config.sequence_length = 10;
    PlaceMap map =
        use == Use::localise ? map_of(drive, config) : PlaceMap(config, {warm_up + frames, 16});
    Detector detector(config, map);
    CameraView view;
    view.allowed = always;
    SteadyClock clock;
    std::atomic<std::size_t> captured_with{0};
    LiveSource source(std::make_unique<FakeCamera>(
                          [&](std::uint64_t n) {
                            static thread_local std::optional<AllocationGuard> guard;
                            if (n == warm_up) guard.emplace();
                            if (n > warm_up) captured_with = guard->count();
                            return act(n);
                          },
                          view, clock),
                      std::make_unique<FakeDecoder>(), clock, {});
    GreedyDescriber describer(drive);
    SamplingClock sampling;
    Pipeline pipeline = pipeline_of(source, describer, detector, sampling);
    Found found;
    for (std::uint64_t n = 0; n < warm_up + frames;) {
      if (n == warm_up + frames / 2) describer.greedy = greedy;
      const auto processed = pipeline.process();
      EXPECT_TRUE(processed);
      sampling.each_stage([&](std::size_t, std::size_t allocations, std::uint64_t page_faults) {
        if (n < warm_up) return;
        ++found.stages;
        found.allocations += allocations;
        found.page_faults += page_faults;
      });
      if (processed->report.gate != Gate::no_frame) ++n;
    }
    EXPECT_EQ(captured_with.load(), 0U) << "nor does the capture thread take memory";
    return found;
  }
};

TEST_P(LiveAllocation, NoStageTakesMemoryOrFaultsAPageIn) {
  for (const Use use : {Use::localise, Use::close_loops}) {
    // A machine that is short of memory takes pages away: of three goes, one without that is
    // enough.
    Found found = run(GetParam(), use, false);
    for (int go = 1; go < 3 && found.page_faults > 0; ++go) found = run(GetParam(), use, false);
    EXPECT_GE(found.stages, 3 * frames) << "grab, describe, match";
    EXPECT_EQ(found.allocations, 0U);
    EXPECT_EQ(found.page_faults, 0U);
  }
}

TEST_P(LiveAllocation, AStageThatDoesIsFound) {
  const Found found = run(GetParam(), Use::localise, true);
  EXPECT_EQ(found.allocations, 1U);
  EXPECT_GE(found.page_faults, 1U);
}

INSTANTIATE_TEST_SUITE_P(Methods, LiveAllocation,
                         testing::Values(Candidates::all, Candidates::ranges,
                                         Candidates::adaptive));

}  // namespace
}  // namespace seqloop::live::test
