// SPDX-License-Identifier: MIT
// A million frames and more, with every fault that a camera has: nothing grows, nothing is
// miscounted.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <iterator>
#include <random>

#include "core/matcher.hpp"
#include "platform/linux/live_rig.hpp"
#include "resident_memory.hpp"
#include "seqloop/linux/live_source.hpp"
#include "seqloop/linux/steady_clock.hpp"

namespace seqloop::live::test {
namespace {

constexpr std::uint64_t enough = SEQLOOP_SOAK_FRAMES;
constexpr std::uint32_t seed = 2024;
constexpr std::uint32_t first_sequence = 4294967295U - 1000;  // wraps early

struct Usage {
  std::uint64_t resident_kib = 0;
  std::size_t open_files = 0;
};

Usage usage() {
  return {seqloop::test::resident_bytes() / 1024,
          static_cast<std::size_t>(
              std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}))};
}

/// What a tired camera does: each kind of fault about every 400 frames. It keeps two frames ahead
/// of the work thread but for bursts, in which it waits for nobody.
class Script {
 public:
  Script(const CameraView& view, const std::atomic<std::uint64_t>& seen)
      : view_(&view), seen_(&seen) {}

  Act operator()(std::uint64_t) {
    if (random_() % 100 == 0) burst_ = random_() % 8;
    if (burst_ > 0) {
      --burst_;
    } else {
      wait();
    }
    switch (random_() % 400) {
      case 0:
        return Act::bad;
      case 1:
        return Act::undecodable;
      case 2:
        return Act::silent;
      case 3:
        away_ = 1 + random_() % 3;
        break;
      case 4:
        return Act::gap;
      default:
        break;
    }
    if (away_ == 0) return Act::frame;
    --away_;
    return Act::lost;
  }

 private:
  void wait() const {
    constexpr int patience = 2000;  // the last frame may have been dropped
    const std::uint64_t brought = view_->frames.load() + view_->lost.load();
    for (int i = 0; i < patience && seen_->load() + 1 < brought; ++i) std::this_thread::yield();
  }

  const CameraView* view_;
  const std::atomic<std::uint64_t>* seen_;
  std::mt19937 random_{seed};
  std::uint64_t burst_ = 0;
  std::uint64_t away_ = 0;  // acts until it is found again
};

constexpr std::size_t sequence_length = 10;

/// What the work thread saw, frame by frame.
struct Tally {
  std::uint64_t taken = 0;
  std::uint64_t answered = 0;
  std::uint64_t failed = 0;
  std::uint64_t matched = 0;
  std::uint64_t lost = 0;
  std::uint64_t dropped = 0;
  std::uint64_t silences = 0;
  std::uint64_t next_index = 0;
  std::uint64_t counted = 0;  // by the detector: long gaps are left out

  void add(const ProcessedFrame& processed) {
    if (processed.report.gate == Gate::no_frame) {
      ++silences;
      return;
    }
    const Frame& frame = processed.frame;
    ++taken;
    ++(processed.fault.empty() ? answered : failed);
    matched += processed.report.gate == Gate::match;
    lost += frame.lost;
    dropped += frame.dropped;
    ASSERT_EQ(frame.index - next_index, frame.lost + frame.dropped) << "frame " << frame.index;
    ASSERT_EQ(frame.sequence, static_cast<std::uint32_t>(first_sequence + frame.index));
    const std::uint64_t gap = frame.lost + frame.dropped;
    counted += taken > 1 && gap <= sequence_length ? gap + 1 : 1;
    ASSERT_EQ(processed.report.newest + 1, counted) << "frame " << frame.index;
    if (frame.fault.empty()) {
      ASSERT_EQ(index_in(frame.image.data), frame.index);
    }
    next_index = frame.index + 1;
  }
};

class Soak : public testing::TestWithParam<Candidates> {};

TEST_P(Soak, StaysFlatAndCountsToTheLastFrame) {
  const oracle::Vectors drive = oracle::drive(seed, 200, 16);
  MatcherConfig config;
  config.candidates = GetParam();
  config.sequence_length = sequence_length;
  PlaceMap map = map_of(drive, config);
  Detector detector(config, map);
  SteadyClock clock;
  CameraView view;
  view.allowed = always;
  std::atomic<std::uint64_t> seen{0};
  LiveSource source(std::make_unique<FakeCamera>(Script(view, seen), view, clock, first_sequence),
                    std::make_unique<FakeDecoder>(), clock, {std::chrono::minutes(5), nullptr, {}});
  FakeDescriber describer(drive);
  Pipeline pipeline = pipeline_of(source, describer, detector, clock);

  Tally tally;
  Usage early = usage();  // once before, for the pages that asking takes
  const Nanoseconds began = clock.now();
  while (tally.taken < enough) {
    const auto processed = pipeline.process();
    ASSERT_TRUE(processed);
    tally.add(*processed);
    if (HasFatalFailure()) return;
    seen.store(tally.next_index);
    if (tally.taken == enough / 10) early = usage();
  }
  const Usage late = usage();
  const double took_s = std::chrono::duration<double>(clock.now() - began).count();
  source.stop();
  const LiveCounts counts = source.counts();

  std::printf(
      "seed %u: delivered %llu = taken %llu + dropped %llu; taken = answered %llu + failed %llu; "
      "matched %llu; lost %llu; silences %llu (told %llu); resident %llu KiB at 10 %%, %llu KiB at "
      "the end; open files %zu, %zu; %.1f s\n",
      seed, static_cast<unsigned long long>(counts.delivered),
      static_cast<unsigned long long>(counts.taken),
      static_cast<unsigned long long>(counts.dropped),
      static_cast<unsigned long long>(tally.answered),
      static_cast<unsigned long long>(tally.failed), static_cast<unsigned long long>(tally.matched),
      static_cast<unsigned long long>(counts.lost),
      static_cast<unsigned long long>(counts.silences),
      static_cast<unsigned long long>(tally.silences),
      static_cast<unsigned long long>(early.resident_kib),
      static_cast<unsigned long long>(late.resident_kib), early.open_files, late.open_files,
      took_s);

  EXPECT_EQ(counts.delivered, view.frames.load());
  EXPECT_EQ(counts.delivered, counts.taken + counts.dropped);
  EXPECT_EQ(counts.taken, tally.taken);
  EXPECT_EQ(counts.taken, tally.answered + tally.failed);
  EXPECT_EQ(counts.failed, tally.failed);
  EXPECT_EQ(counts.lost, view.lost.load());
  EXPECT_EQ(tally.next_index, tally.taken + tally.lost + tally.dropped);
  EXPECT_LE(tally.dropped, counts.dropped) << "what came after the last frame is told to nobody";
  EXPECT_EQ(counts.silences, view.silences.load());
  EXPECT_LE(tally.silences, counts.silences);
  // Whether a silence is told, or frames that wait hide it, depends on how busy the machine is.
  for (const std::uint64_t faults :
       {tally.failed, tally.lost, tally.dropped, counts.silences, tally.matched}) {
    EXPECT_GE(faults, enough / 10'000) << "too few to mean anything";
  }
  EXPECT_LE(view.most_out.load(), CaptureDevice::most_out);
  EXPECT_EQ(view.broken_rules.load(), 0U);
  EXPECT_EQ(view.out.load(), 0U);
  EXPECT_EQ(view.given_back.load(), counts.delivered);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LE(late.resident_kib, early.resident_kib + 64);
#endif
  EXPECT_EQ(late.open_files, early.open_files);
}

INSTANTIATE_TEST_SUITE_P(Methods, Soak, testing::Values(Candidates::ranges, Candidates::adaptive));

}  // namespace
}  // namespace seqloop::live::test
