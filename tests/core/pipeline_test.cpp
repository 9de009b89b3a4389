// Grab, describe, match, with fakes for everything outside.
#include "seqloop/pipeline.hpp"

#include "core/matcher.hpp"

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
    return Description::good;
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
  PlaceMap map = map_of(drive);
  Detector detector(paper(Candidates::all, 6), map);
  Pipeline pipeline(source, &describer, detector, clock, 16, Pace::max);
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

TEST(Pipeline, LivePaceKeepsEachFrameUntilItsTime) {
  const oracle::Vectors drive = oracle::drive(3, 12, 16);
  FakeSource source(12);
  FakeDescriber describer(drive);
  FakeClock clock;
  PlaceMap map = map_of(drive);
  Detector detector(paper(Candidates::all, 6), map);
  Pipeline pipeline(source, &describer, detector, clock, 16, Pace::live);
  while (pipeline.process()) {
  }
  EXPECT_GE(clock.now(), std::chrono::milliseconds(5500)) << "frame 11 is due at 5.5 s";
  EXPECT_LT(clock.now(), std::chrono::milliseconds(5501));
}

}  // namespace
}  // namespace seqloop
