// SPDX-License-Identifier: MIT
// A recording played as a camera, on a clock that nobody waits for.
#include "seqloop/linux/recording_capture.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <numeric>

namespace seqloop::live {
namespace {

using std::chrono::milliseconds;

class FakeClock : public Clock {
 public:
  Nanoseconds now() noexcept override { return now_; }
  void sleep_until(Nanoseconds moment) noexcept override {
    longest_sleep = std::max(longest_sleep, moment - now_);
    now_ = std::max(now_, moment);
  }
  void pass(Nanoseconds time) noexcept { now_ += time; }

  Nanoseconds longest_sleep{0};

 private:
  Nanoseconds now_ = std::chrono::hours(1);
};

struct Recorded {
  double time_s = 0.0;
  int width = 4;  // 0: unreadable
  PixelFormat format = PixelFormat::gray8;
  std::vector<float> descriptor = {};
  Nanoseconds reading{0};  // how long it takes
};

/// A recording whose rows are padded, so that strides matter. Pixel i of frame n is n + i.
class FakeRecording : public FrameSource {
 public:
  FakeRecording(std::vector<Recorded> frames, FakeClock& clock)
      : frames_(std::move(frames)), clock_(&clock) {}

  Grab grab(Frame& frame) noexcept override {
    frame = {};
    if (next_ == frames_.size()) return Grab::end;
    const Recorded& recorded = frames_[next_];
    clock_->pass(recorded.reading);
    frame.index = next_;
    frame.time_s = recorded.time_s;
    pixels_.assign(10'000, 0);
    std::iota(pixels_.begin(), pixels_.end(), static_cast<std::uint8_t>(next_++));
    if (!recorded.descriptor.empty()) {
      frame.descriptor = recorded.descriptor;
      return Grab::frame;
    }
    if (recorded.width == 0) {
      frame.fault = "torn";
      return Grab::unreadable;
    }
    const std::size_t channels = recorded.format == PixelFormat::bgr8 ? 3 : 1;
    frame.image = {pixels_.data(), recorded.width, 3,
                   static_cast<std::size_t>(recorded.width) * channels + 5, recorded.format};
    return Grab::frame;
  }
  std::optional<std::uint64_t> frame_count() const noexcept override { return frames_.size(); }

 private:
  std::vector<Recorded> frames_;
  FakeClock* clock_;
  std::size_t next_ = 0;
  std::vector<std::uint8_t> pixels_;
};

std::vector<Recorded> at_25_hz(std::size_t frames) {
  std::vector<Recorded> recorded(frames);
  for (std::size_t i = 0; i < frames; ++i) recorded[i].time_s = 0.04 * static_cast<double>(i);
  return recorded;
}

class Player {
 public:
  explicit Player(std::vector<Recorded> frames) : recording_(std::move(frames), clock) {}

  /// The next capture that is something.
  Captured next() {
    Captured captured;
    do {
      capture_.next(captured, stop);
    } while (captured.what == Capture::nothing);
    return captured;
  }
  void give_back(const Captured& captured) { capture_.give_back(captured); }

  FakeClock clock;
  std::atomic<bool> stop{false};

 private:
  FakeRecording recording_;
  RecordingCapture capture_{recording_, clock};
};

/// Whether the picture is frame n's, row by row.
void expect_picture(const Captured& captured, std::size_t row, std::size_t padded) {
  ASSERT_EQ(captured.picture.stride, row);
  ASSERT_EQ(captured.picture.bytes.size(), row * 3);
  for (std::size_t y = 0; y < 3; ++y) {
    for (std::size_t x = 0; x < row; ++x) {
      ASSERT_EQ(captured.picture.bytes[y * row + x],
                static_cast<std::uint8_t>(captured.index + y * padded + x));
    }
  }
}

TEST(RecordingCapture, BringsEveryFrameInOrderAtItsTime) {
  Player player(at_25_hz(30));
  const Nanoseconds start = player.clock.now();
  for (std::uint64_t index = 0; index < 30; ++index) {
    const Captured captured = player.next();
    ASSERT_EQ(captured.what, Capture::frame);
    EXPECT_EQ(captured.index, index);
    EXPECT_EQ(captured.delivered, index);
    EXPECT_EQ(captured.sequence, index);
    EXPECT_NEAR(static_cast<double>((captured.stamp - start).count()),
                4e7 * static_cast<double>(index), 10.0);
    EXPECT_EQ(captured.arrived, captured.stamp);
    EXPECT_EQ(player.clock.now(), captured.arrived);
    expect_picture(captured, 4, 9);
    player.give_back(captured);
  }
  EXPECT_EQ(player.next().what, Capture::end);
  EXPECT_EQ(player.next().what, Capture::end);
}

TEST(RecordingCapture, NeverSleepsLongerThanTheStopMayWait) {
  Player player({{.time_s = 0.0}, {.time_s = 2.0}});
  player.give_back(player.next());
  EXPECT_EQ(player.next().index, 1U);
  EXPECT_LE(player.clock.longest_sleep, milliseconds(50));
}

TEST(RecordingCapture, FramesThatTakeTooLongToReadArriveAfterTheirStamp) {
  std::vector<Recorded> frames = at_25_hz(4);
  frames[0].reading = milliseconds(500);  // opening: the first frame's time is when it is read
  frames[2].reading = milliseconds(100);
  Player player(std::move(frames));
  const Captured first = player.next();
  EXPECT_EQ(first.arrived, first.stamp);
  const Captured second = player.next();
  EXPECT_EQ(second.arrived, second.stamp);
  const Captured third = player.next();
  EXPECT_EQ(third.arrived - third.stamp, milliseconds(60));
  EXPECT_EQ(third.stamp - second.stamp, milliseconds(40));
}

TEST(RecordingCapture, TheEndTellsOfFramesThatWereLostBeforeIt) {
  std::vector<Recorded> frames = at_25_hz(12);
  frames[9].reading = milliseconds(500);
  Player player(std::move(frames));
  for (std::uint64_t index = 0; index < 9; ++index) {
    const Captured captured = player.next();
    ASSERT_EQ(captured.index, index);
    player.give_back(captured);
  }
  const Captured end = player.next();
  ASSERT_EQ(end.what, Capture::end) << "the last three came too late";
  EXPECT_EQ(end.index, 12U);
  EXPECT_EQ(end.delivered, 9U);
}

TEST(RecordingCapture, UnreadableFramesAreBadOnesAndKeepTheirTime) {
  std::vector<Recorded> frames = at_25_hz(3);
  frames[1].width = 0;
  Player player(std::move(frames));
  const Captured first = player.next();
  const Captured torn = player.next();
  EXPECT_EQ(torn.what, Capture::bad_frame);
  EXPECT_EQ(torn.fault.view(), "torn");
  EXPECT_EQ(torn.index, 1U);
  EXPECT_EQ(torn.stamp - first.stamp, milliseconds(40));
  player.give_back(torn);
  const Captured third = player.next();
  EXPECT_EQ(third.what, Capture::frame);
  EXPECT_EQ(third.delivered, 2U);
  expect_picture(first, 4, 9);
}

TEST(RecordingCapture, AsManyAsMayBeOutKeepTheirPictures) {
  Player player(at_25_hz(200));
  std::deque<Captured> out;
  for (int i = 0; i < 200; ++i) {
    if (out.size() == CaptureDevice::most_out) {
      player.give_back(out.front());
      out.pop_front();
    }
    out.push_back(player.next());
    for (const Captured& captured : out) expect_picture(captured, 4, 9);
  }
}

TEST(RecordingCapture, PicturesMayGrowShrinkAndTurnColoured) {
  std::vector<Recorded> frames = at_25_hz(40);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].width = static_cast<int>(1 + i * i * 7 % 50);
    frames[i].format = i % 3 == 0 ? PixelFormat::bgr8 : PixelFormat::gray8;
  }
  Player player(frames);
  for (const Recorded& recorded : frames) {
    const bool colour = recorded.format == PixelFormat::bgr8;
    const Captured captured = player.next();
    const std::size_t row = static_cast<std::size_t>(recorded.width) * (colour ? 3 : 1);
    EXPECT_EQ(captured.picture.width, recorded.width);
    EXPECT_EQ(captured.picture.height, 3);
    EXPECT_EQ(captured.picture.format, colour ? RawFormat::bgr8 : RawFormat::gray8);
    expect_picture(captured, row, row + 5);
    player.give_back(captured);
  }
}

TEST(RecordingCapture, APictureOfAFormatThatIsNoneIsABadFrame) {
  std::vector<Recorded> frames = at_25_hz(2);
  frames[0].format = PixelFormat{77};
  Player player(std::move(frames));
  const Captured bad = player.next();
  EXPECT_EQ(bad.what, Capture::bad_frame);
  EXPECT_EQ(bad.fault.view(), "the picture's format is none of its values: take gray8 or bgr8");
  EXPECT_EQ(player.next().what, Capture::frame);
}

TEST(RecordingCapture, DescriptorsKeepTheirTimeToo) {
  std::vector<Recorded> frames = at_25_hz(3);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].descriptor = {static_cast<float>(i), 1.0F};
  }
  Player player(std::move(frames));
  const Captured first = player.next();
  const Captured second = player.next();
  ASSERT_EQ(first.descriptor.size(), 2U);
  EXPECT_EQ(first.descriptor[0], 0.0F);
  EXPECT_EQ(second.descriptor[0], 1.0F);
  EXPECT_TRUE(second.picture.bytes.empty());
  EXPECT_EQ(second.stamp - first.stamp, milliseconds(40));
}

TEST(RecordingCapture, TimesThatGoBackStandStill) {
  Player player({{.time_s = 0.0}, {.time_s = 0.2}, {.time_s = 0.1}});
  player.give_back(player.next());
  const Captured second = player.next();
  const Captured third = player.next();
  EXPECT_EQ(third.time_s, 0.2);
  EXPECT_EQ(third.stamp, second.stamp);
}

}  // namespace
}  // namespace seqloop::live
