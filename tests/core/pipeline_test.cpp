// SPDX-License-Identifier: MIT
// Grab, describe, match, with fakes for everything outside.
#include "seqloop/pipeline.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/matcher.hpp"
#include "expect_setup_error.hpp"

namespace seqloop {
namespace {

class FakeClock : public Clock {
 public:
  Nanoseconds now() noexcept override { return now_ += Nanoseconds(10); }
  void sleep_until(Nanoseconds moment) noexcept override { now_ = std::max(now_, moment); }

 private:
  Nanoseconds now_{0};
};

class FakeSource : public FrameSource {
 public:
  explicit FakeSource(std::size_t frames) : frames_(frames) {}

  Grab grab(Frame& frame) noexcept override {
    frame = {};
    frame.index = next_;
    frame.time_s = 0.5 * static_cast<double>(next_);
    if (next_ == frames_) return Grab::end;
    const std::size_t index = next_++;
    if (index == 5) {
      frame.fault = "torn";
      return Grab::unreadable;
    }
    pixel_ = static_cast<std::uint8_t>(index);
    frame.image = {&pixel_, 1, 1, 1, PixelFormat::gray8};
    return Grab::frame;
  }
  std::optional<std::uint64_t> frame_count() const noexcept override { return frames_; }

 private:
  std::size_t frames_;
  std::size_t next_ = 0;
  std::uint8_t pixel_ = 0;
};

class FakeDescriber : public Describer {
 public:
  explicit FakeDescriber(oracle::Vectors drive) : drive_(std::move(drive)) {}
  std::size_t size() const noexcept override { return drive_.front().size(); }
  Description describe(const Image& image, std::span<float> descriptor) noexcept override {
    if (*image.data == 7) return Description::failed;
    std::ranges::copy(drive_[*image.data], descriptor.begin());
    const bool zero = std::ranges::all_of(descriptor, [](float value) { return value == 0.0F; });
    return zero ? Description::blank : Description::good;
  }
  std::string_view last_fault() const noexcept override { return "blurred"; }

 private:
  oracle::Vectors drive_;
};

TEST(Pipeline, TakesEveryFrameThroughEveryStage) {
  const oracle::Vectors drive = oracle::drive(3, 30, 16);
  FakeSource source(30);
  FakeDescriber describer(drive);
  FakeClock clock;
  PlaceMap map = map_of(drive, paper(Candidates::all, 6));
  Detector detector(paper(Candidates::all, 6), map);
  Pipeline pipeline(source, &describer, detector, clock, 16);
  std::size_t frames = 0;
  while (const auto processed = pipeline.process()) {
    EXPECT_EQ(processed->frame.index, frames);
    const bool bad = frames == 5 || frames == 7;
    EXPECT_EQ(processed->report.gate == Gate::frame_error, bad);
    EXPECT_EQ(processed->fault, frames == 5 ? "torn" : frames == 7 ? "blurred" : "");
    EXPECT_EQ(processed->times.grab.count(), 10);
    EXPECT_EQ(processed->times.describe.count(), 10);
    EXPECT_EQ(processed->times.match.count(), 10);
    EXPECT_EQ(processed->times.total.count(), 30);
    ++frames;
  }
  EXPECT_EQ(frames, 30U);
}

/// Loses 3 frames before its frame 10, drops 2 before 20, 30 before 25, and has nothing now and
/// then.
class LiveFake : public FakeSource {
 public:
  using FakeSource::FakeSource;

  Grab grab(Frame& frame) noexcept override {
    if (++calls_ % 7 == 0) {
      frame = {};
      frame.fault = "no frame for a second";
      return Grab::silent;
    }
    const Grab grab = FakeSource::grab(frame);
    frame.age = Nanoseconds(33);
    frame.waited = Nanoseconds(4);
    if (frame.index == 10) frame.lost = 3;
    if (frame.index == 20) frame.dropped = 2;
    if (frame.index == 25) frame.dropped = 30;
    return grab;
  }

 private:
  int calls_ = 0;
};

TEST(Pipeline, CountsWhatNeverCameAndGoesOn) {
  const oracle::Vectors drive = oracle::drive(3, 40, 16);
  LiveFake source(40);
  FakeDescriber describer(drive);
  FakeClock clock;
  PlaceMap map = map_of(drive, paper(Candidates::all, 6));
  Detector detector(paper(Candidates::all, 6), map);
  Pipeline pipeline(source, &describer, detector, clock, 16);
  std::uint64_t frames = 0;
  std::uint64_t silences = 0;
  while (const auto processed = pipeline.process()) {
    if (processed->report.gate == Gate::no_frame) {
      EXPECT_EQ(processed->fault, "no frame for a second");
      ++silences;
      continue;
    }
    const std::uint64_t skipped = frames < 10 ? 0 : frames < 20 ? 3 : 5;
    EXPECT_EQ(processed->report.newest, frames + skipped) << "30 of them are not counted";
    const bool warming_up = frames < 6 || (frames >= 25 && frames < 25 + 6);
    const bool bad = frames == 5 || frames == 7;
    if (!bad) {
      EXPECT_EQ(processed->report.gate == Gate::warming_up, warming_up) << frames;
    }
    EXPECT_EQ(processed->times.age.count(), 33);
    EXPECT_EQ(processed->times.grab.count(), 10 - 4);
    EXPECT_EQ(processed->times.total.count(), 30 - 4);
    ++frames;
  }
  EXPECT_EQ(frames, 40U);
  EXPECT_EQ(silences, 6U);
}

/// What is said of a frame that cannot be read. @param changed how its descriptor is
std::string fault_of(const MatcherConfig& config,
                     const std::function<void(std::vector<float>&)>& changed) {
  oracle::Vectors drive = oracle::drive(3, 30, 16);
  PlaceMap map = map_of(drive, config);
  Detector detector(config, map);
  changed(drive[0]);
  FakeSource source(1);
  FakeDescriber describer(drive);
  FakeClock clock;
  Pipeline pipeline(source, &describer, detector, clock, 16);
  const auto processed = pipeline.process();
  EXPECT_EQ(processed->report.gate, Gate::frame_error);
  return std::string(processed->fault);
}

TEST(Pipeline, SaysThatADescriptorIsNotFinite) {
  const std::string fault = fault_of(paper(Candidates::all, 6), [](std::vector<float>& descriptor) {
    descriptor[3] = std::numeric_limits<float>::quiet_NaN();
  });
  EXPECT_TRUE(test::says(fault, "not finite"));
}

// A covered lens is no fault of the descriptor.
TEST(Pipeline, SaysThatAPictureIsBlank) {
  MatcherConfig config = paper(Candidates::all, 6);
  config.blank_is_unreadable = true;
  EXPECT_EQ(fault_of(config, [](std::vector<float>& all) { std::ranges::fill(all, 0.0F); }),
            "its picture is blank, without any feature");
}

/// A recording that was described before, by something else.
class DescribedFake : public FakeSource {
 public:
  using FakeSource::FakeSource;

  Grab grab(Frame& frame) noexcept override {
    const Grab grab = FakeSource::grab(frame);
    frame.descriptor = descriptor_;
    return grab;
  }

 private:
  std::vector<float> descriptor_{1.0F, 0.0F};
};

TEST(Pipeline, SaysThatARecordedDescriptorIsOfAnotherSize) {
  const MatcherConfig config = paper(Candidates::all, 6);
  PlaceMap map = map_of(oracle::drive(3, 30, 16), config);
  Detector detector(config, map);
  DescribedFake source(1);
  FakeClock clock;
  Pipeline pipeline(source, nullptr, detector, clock, 16);
  const auto processed = pipeline.process();
  ASSERT_TRUE(processed);
  EXPECT_EQ(processed->report.gate, Gate::frame_error);
  EXPECT_EQ(processed->fault, "its descriptor is of another size than the map's");
}

TEST(Pipeline, SaysWhichSizesDifferBeforeTheFirstFrame) {
  const MatcherConfig config = paper(Candidates::all, 6);
  PlaceMap map = map_of(oracle::drive(3, 30, 16), config);
  Detector detector(config, map);
  FakeSource source(30);
  FakeDescriber describer(oracle::drive(3, 30, 24));
  FakeClock clock;
  const auto message = [&](std::size_t descriptor_size) {
    return test::setup_error(
        [&] { const Pipeline pipeline(source, &describer, detector, clock, descriptor_size); });
  };
  EXPECT_EQ(message(24),
            "describer: its descriptors have 24 values, those of the detector's map 16; make the "
            "map for the describer's size, or take what described the map");
  EXPECT_TRUE(test::says(message(16), "those of the detector's map 16;"));
  EXPECT_TRUE(test::says(message(16), "descriptor_size: 16, where the describer writes 24 values"));
}

}  // namespace
}  // namespace seqloop
