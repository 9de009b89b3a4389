// SPDX-License-Identifier: MIT
// A camera that runs: what frames carry, and how it heals itself.
#include <algorithm>
#include <cerrno>

#include "expect_setup_error.hpp"
#include "platform/linux/camera_bench.hpp"

namespace seqloop::live::test {
namespace {

using seqloop::test::says;

class CameraRuns : public CameraBench {
 protected:
  void SetUp() override { kernel_.plug("/dev/video0"); }
  FakeCamera& camera() { return kernel_.at("/dev/video0"); }

  static std::string text(const FixedText& words) { return std::string(words.view()); }

  /// After an outage, the index says how much time has gone by: 10 frames a second.
  static void expect_index_by_time(const Captured& captured) {
    EXPECT_NEAR(static_cast<double>(captured.index), 10.0 * captured.time_s, 3.0);
  }
};

TEST_F(CameraRuns, BringsFramesInOrder) {
  (void)open();
  Nanoseconds last{0};
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Captured captured = next();
    ASSERT_EQ(captured.what, Capture::frame);
    EXPECT_EQ(captured.index, i);
    EXPECT_EQ(captured.delivered, i);
    EXPECT_EQ(captured.sequence, i);
    EXPECT_EQ(captured.picture.bytes.size(), 64U * 48 * 2);
    EXPECT_EQ(captured.picture.bytes.front(), i + 1);
    EXPECT_EQ(captured.picture.format, RawFormat::yuyv);
    EXPECT_GT(captured.stamp, last);
    EXPECT_LE(captured.stamp, captured.arrived);
    EXPECT_NEAR(captured.time_s, static_cast<double>(i) * 0.1, 1e-3);
    EXPECT_EQ(text(captured.remark), "");
    last = captured.stamp;
    camera_->give_back(captured);
  }
  EXPECT_EQ(camera_->counters().frames, 50U);
  EXPECT_EQ(camera_->counters().missed, 0U);
}

TEST_F(CameraRuns, LeavesAGapForFramesThatTheDeviceLost) {
  (void)open();
  (void)frame();
  std::vector<Captured> held = {next(), next(), next()};
  clock_.advance(1s);  // nobody takes frames: the others fill up, and then some are lost
  for (const Captured& captured : held) camera_->give_back(captured);
  std::uint64_t last = held.back().index;
  for (int i = 0; i < 20; ++i) last = frame().index;
  const CameraCounters counters = camera_->counters();
  EXPECT_GT(counters.missed, 3U);
  EXPECT_EQ(counters.frames + counters.missed, last + 1);
}

TEST_F(CameraRuns, GoesOnAcrossTheWrapOfTheSequence) {
  camera().first_sequence = 0xFFFFFFFD;
  (void)open();
  for (std::uint64_t i = 0; i < 8; ++i) EXPECT_EQ(frame().index, i);
  EXPECT_EQ(camera_->counters().missed, 0U);
}

TEST_F(CameraRuns, TellsFramesThatAreNoGood) {
  (void)open();
  (void)frame();
  const auto bad = [&](const std::function<void(v4l2_buffer&)>& edit) {
    camera().edit = edit;
    const Captured captured = next();
    camera_->give_back(captured);
    camera().edit = nullptr;
    EXPECT_EQ(captured.what, Capture::bad_frame);
    EXPECT_TRUE(captured.picture.bytes.empty());
    return text(captured.fault);
  };
  EXPECT_TRUE(says(bad([](v4l2_buffer& b) { b.flags |= V4L2_BUF_FLAG_ERROR; }), "damaged"));
  EXPECT_TRUE(says(bad([](v4l2_buffer& b) { b.bytesused = 0; }), "empty"));
  EXPECT_TRUE(says(bad([](v4l2_buffer& b) { --b.bytesused; }), "too few bytes"));
  EXPECT_TRUE(says(bad([](v4l2_buffer& b) { ++b.bytesused; }), "more bytes"));
  EXPECT_TRUE(says(bad([](v4l2_buffer& b) { b.index = 77; }), "did not have"));
  const Captured held = next();
  camera().edit = [&](v4l2_buffer& b) { b.index = held.buffer % 64; };
  EXPECT_TRUE(says(text(next().fault), "did not have"));
  camera().edit = nullptr;
  camera_->give_back(held);
  const Captured good = frame();
  EXPECT_EQ(good.index, 8U);
  EXPECT_EQ(good.delivered, 8U);
  EXPECT_EQ(camera_->counters().bad, 6U);
  EXPECT_EQ(camera_->counters().reopenings, 0U);
}

TEST_F(CameraRuns, TakesTheLastRowWithoutItsPadding) {
  camera().row_padding = 12;
  camera().edit = [](v4l2_buffer& b) { b.bytesused -= 12; };
  (void)open();
  const Captured captured = frame();
  EXPECT_EQ(captured.picture.bytes.size(), 140U * 48);
}

TEST_F(CameraRuns, UsesTheArrivalWhereStampsAreOddAndSaysSoOnce) {
  camera().stamp_flag = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  (void)open();
  EXPECT_TRUE(says(text(frame().remark), "unknown clock"));
  for (int i = 0; i < 20; ++i) {
    const Captured captured = frame();
    EXPECT_EQ(captured.stamp, captured.arrived);
    EXPECT_EQ(text(captured.remark), "");
  }
  EXPECT_EQ(camera_->counters().odd_stamps[static_cast<std::size_t>(OddStamp::other_clock)], 21U);
}

TEST_F(CameraRuns, ReturnsSoonOnceItIsToStop) {
  camera().silent = true;
  (void)open();
  stop_ = true;
  const Nanoseconds begin = clock_.now();
  EXPECT_EQ(next().what, Capture::nothing);
  EXPECT_LT(clock_.now() - begin, 50ms);
  stop_ = false;
  kernel_.fault = [&](Call call, std::uint64_t) {
    if (call == Call::poll) stop_ = true;
    return 0;
  };
  EXPECT_EQ(next().what, Capture::nothing);
  EXPECT_LT(clock_.now() - begin, 110ms);
}

TEST_F(CameraRuns, SaysThatItIsSilentAndStartsAnew) {
  (void)open();
  (void)frame();
  camera().silent = true;
  for (int i = 1; i <= 3; ++i) {
    const Nanoseconds begin = clock_.now();
    const Captured captured = next();
    EXPECT_EQ(captured.what, Capture::silent);
    EXPECT_NEAR(static_cast<double>((clock_.now() - begin) / 1ms), 1000.0, 60.0);
    EXPECT_TRUE(says(text(captured.fault), "no frame from /dev/video0 for " + std::to_string(i)));
  }
  EXPECT_EQ(camera_->counters().restarts, 1U);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(next().what, Capture::silent);
  (void)next();
  EXPECT_EQ(camera_->counters().reopenings, 1U);
  camera().silent = false;
  const Captured captured = frame();
  expect_index_by_time(captured);
  EXPECT_TRUE(says(text(captured.remark), "opened anew after: no frame"));
}

TEST_F(CameraRuns, OnlyDamagedFramesAreAsGoodAsNone) {
  (void)open();
  (void)frame();
  camera().edit = [](v4l2_buffer& buffer) { buffer.flags |= V4L2_BUF_FLAG_ERROR; };
  for (int i = 0; i < 100; ++i) EXPECT_EQ(first(Capture::bad_frame).what, Capture::bad_frame);
  EXPECT_EQ(camera_->counters().restarts, 1U) << "after 3 s";
  EXPECT_GE(camera_->counters().reopenings, 1U);
  EXPECT_LE(camera_->counters().reopenings, 3U) << "10 s in all";
  camera().edit = {};
  expect_index_by_time(frame());
}

TEST_F(CameraRuns, StartsAnewLessAndLessOften) {
  (void)open();
  camera().silent = true;
  for (int i = 0; i < 400; ++i) EXPECT_EQ(next().what, Capture::silent);
  EXPECT_EQ(camera_->counters().silences, 400U);
  EXPECT_LE(camera_->counters().reopenings, 8U);
  EXPECT_GE(camera_->counters().reopenings, 4U);
}

TEST_F(CameraRuns, RestartsTheStreamAfterAnErrorAndOpensAnewIfThatDoesNotHelp) {
  (void)open();
  (void)frame();
  camera().first_sequence = 100;
  fail(Call::dequeue, EIO);
  Captured captured = frame();
  expect_index_by_time(captured);
  EXPECT_TRUE(says(text(captured.remark),
                   "the stream was started anew after: taking a frame: Input/output"));
  camera().first_sequence = 200;
  fail(Call::dequeue, EIO, 2);
  captured = frame();
  expect_index_by_time(captured);
  EXPECT_TRUE(says(text(captured.remark), "opened anew after: taking a frame"));
  EXPECT_EQ(camera_->counters().restarts, 2U);
  EXPECT_EQ(camera_->counters().reopenings, 1U);
}

TEST_F(CameraRuns, IsLostAndComesBackUnderAnotherName) {
  (void)open();
  (void)frame();
  auto unplugged = kernel_.pull("/dev/video0");
  const Nanoseconds begin = clock_.now();
  Captured captured = next();
  EXPECT_EQ(captured.what, Capture::lost);
  EXPECT_LT(clock_.now() - begin, 200ms);  // told at once
  EXPECT_TRUE(says(text(captured.fault), "Eye is not there"));
  const std::uint64_t calls_before = kernel_.total_calls();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(next().what, Capture::lost);
  EXPECT_LT(kernel_.total_calls() - calls_before, 100U);
  EXPECT_EQ(camera_->counters().losses, 1U);
  kernel_.replug("/dev/video3", unplugged);
  captured = frame();
  expect_index_by_time(captured);
  EXPECT_GT(captured.index, 50U) << "what would have come counts as lost";
  EXPECT_EQ(camera_->counters().missed, captured.index - captured.delivered);
  EXPECT_TRUE(says(text(captured.remark), "found as /dev/video3"));
  EXPECT_EQ(camera_->facts().path, "/dev/video3");
}

// As a container may be given it.
TEST_F(CameraRuns, IsFoundAgainUnderANameOfItsOwn) {
  kernel_.replug("/dev/camera", kernel_.pull("/dev/video0"));
  options_.path = "/dev/camera";
  (void)open();
  (void)frame();
  auto unplugged = kernel_.pull("/dev/camera");
  for (int i = 0; i < 5; ++i) EXPECT_EQ(next().what, Capture::lost);
  kernel_.replug("/dev/camera", unplugged);
  (void)frame();
  EXPECT_EQ(camera_->facts().path, "/dev/camera");
}

TEST_F(CameraRuns, UnderANameOfItsOwnIsNotTakenForItsTwin) {
  camera().serial.clear();
  kernel_.replug("/dev/camera", kernel_.pull("/dev/video0"));
  FakeCamera twin = kernel_.at("/dev/camera");
  twin.bus = "usb-2";
  kernel_.plug("/dev/video1", twin);
  options_.path = "/dev/camera";
  (void)open();
  (void)kernel_.pull("/dev/camera");
  for (int i = 0; i < 5; ++i) EXPECT_EQ(next().what, Capture::lost);
}

TEST_F(CameraRuns, IsNotTakenForItsTwin) {
  FakeCamera twin;
  twin.serial = "2";
  twin.bus = "usb-2";
  kernel_.plug("/dev/video1", twin);
  (void)open();
  auto unplugged = kernel_.pull("/dev/video0");
  kernel_.replug("/dev/video0", kernel_.pull("/dev/video1"));  // it moved up
  for (int i = 0; i < 5; ++i) EXPECT_EQ(next().what, Capture::lost);
  unplugged->bus = "usb-3";
  kernel_.replug("/dev/video5", unplugged);
  (void)frame();
  EXPECT_EQ(camera_->facts().path, "/dev/video5");
  EXPECT_EQ(camera_->facts().identity.serial, "1");
}

TEST_F(CameraRuns, IsNotTakenForATwinThatHasTheSameSerial) {
  FakeCamera twin;
  twin.bus = "usb-2";
  kernel_.plug("/dev/video1", twin);
  (void)open();
  auto unplugged = kernel_.pull("/dev/video0");
  for (int i = 0; i < 5; ++i) EXPECT_EQ(next().what, Capture::lost);
  kernel_.replug("/dev/video7", unplugged);  // at its old place
  (void)frame();
  EXPECT_EQ(camera_->facts().path, "/dev/video7");
}

TEST_F(CameraRuns, IsNotTakenForATwinThatHasNoSerialEither) {
  camera().serial.clear();
  kernel_.replug("/dev/video0", kernel_.pull("/dev/video0"));
  FakeCamera twin = camera();
  twin.bus = "usb-2";
  kernel_.plug("/dev/video1", twin);
  (void)open();
  auto unplugged = kernel_.pull("/dev/video0");
  for (int i = 0; i < 5; ++i) EXPECT_EQ(next().what, Capture::lost);
  kernel_.replug("/dev/video7", unplugged);  // at its old place
  (void)frame();
  EXPECT_EQ(camera_->facts().path, "/dev/video7");
}

TEST_F(CameraRuns, WithoutASerialIsFoundElsewhereIfItIsTheOnlyOne) {
  camera().serial.clear();
  kernel_.replug("/dev/video0", kernel_.pull("/dev/video0"));
  (void)open();
  auto unplugged = kernel_.pull("/dev/video0");
  unplugged->bus = "usb-9";
  FakeCamera other;
  other.card = "Ear";
  kernel_.plug("/dev/video0", other);
  kernel_.replug("/dev/video1", unplugged);
  (void)frame();
  EXPECT_EQ(camera_->facts().path, "/dev/video1");
}

TEST_F(CameraRuns, FollowsALinkOfTheUsers) {
  options_.path = "/dev/v4l/by-id/eye";
  kernel_.link(options_.path, "/dev/video0");
  (void)open();
  (void)kernel_.pull("/dev/video0");
  (void)first(Capture::lost);
  FakeCamera other;
  other.serial = "9";
  kernel_.plug("/dev/video4", other);
  EXPECT_EQ(next().what, Capture::lost);
  kernel_.link(options_.path, "/dev/video4");
  EXPECT_TRUE(says(text(frame().remark), "opened anew"));
  EXPECT_EQ(camera_->facts().identity.serial, "9");
}

TEST_F(CameraRuns, TakesUpANewFormat) {
  (void)open();
  (void)frame();
  camera().offered = {{V4L2_PIX_FMT_UYVY, 80, 60, {10}}};
  camera().events = 1;
  Captured captured = frame();
  EXPECT_EQ(captured.index, 1U);
  EXPECT_EQ(captured.picture.width, 80);
  EXPECT_EQ(captured.picture.format, RawFormat::uyvy);
  EXPECT_TRUE(says(text(captured.remark), "now UYVY 80x60 at 10 fps"));
  // Behind our back, by a driver that does not say so.
  camera().mode.width = 40;
  camera().edit = [](v4l2_buffer& b) { b.bytesused /= 2; };
  EXPECT_EQ(next().what, Capture::bad_frame);
  camera().edit = nullptr;
  EXPECT_TRUE(says(text(frame().remark), "the camera changed its format"));
}

TEST_F(CameraRuns, SeesANewFormatWhenTheStreamIsStartedAnew) {
  (void)open();
  (void)frame();
  camera().mode.height = 40;
  fail(Call::dequeue, EIO);
  EXPECT_TRUE(says(text(frame().remark), "the camera changed its format"));
  EXPECT_EQ(camera_->counters().restarts, 0U);
}

TEST_F(CameraRuns, DoesNotSpinOnADriverThatCriesWolf) {
  (void)open();
  kernel_.fault = [&](Call call, std::uint64_t) { return call == Call::dequeue ? EAGAIN : 0; };
  const std::uint64_t before = kernel_.total_calls();
  EXPECT_EQ(next().what, Capture::silent);
  EXPECT_LT(kernel_.total_calls() - before, 500U);
}

TEST_F(CameraRuns, KeepsFramesThatAreOutReadableWhenTheDeviceGoes) {
  (void)open();
  const Captured a = next();
  const Captured b = next();
  const std::vector<std::uint8_t> before(b.picture.bytes.begin(), b.picture.bytes.end());
  auto unplugged = kernel_.pull("/dev/video0");
  (void)first(Capture::lost);
  EXPECT_EQ(camera_->retired(), 1U);
  EXPECT_EQ(kernel_.mapped(), 2U);
  EXPECT_EQ(kernel_.open_files(), 0U);
  kernel_.replug("/dev/video0", unplugged);
  Captured c = next();
  ASSERT_EQ(c.what, Capture::frame);
  expect_index_by_time(c);
  EXPECT_TRUE(std::ranges::equal(before, b.picture.bytes));
  camera_->give_back(b);
  camera_->give_back(b);  // once is enough
  EXPECT_EQ(camera_->retired(), 1U);
  camera_->give_back(a);
  EXPECT_EQ(camera_->retired(), 0U);
  camera_->give_back(c);
  EXPECT_EQ(kernel_.mapped(), 6U);
  for (int i = 0; i < 20; ++i) (void)frame();
}

TEST_F(CameraRuns, OpensAnewWhileFramesAreOut) {
  (void)open();
  const std::vector<Captured> held = {next(), next()};
  fail(Call::dequeue, EIO, 2);
  const Captured captured = next();
  EXPECT_EQ(captured.what, Capture::frame);
  expect_index_by_time(captured);
  EXPECT_EQ(camera_->retired(), 1U);
  for (const Captured& one : held) camera_->give_back(one);
  camera_->give_back(captured);
}

TEST_F(CameraRuns, WaitsForFramesThatAreOutWhereTheDriverCannotLetGoOfThem) {
  camera().orphans = false;
  (void)open();
  const Captured held = next();
  fail(Call::dequeue, EIO, 2);
  EXPECT_EQ(next().what, Capture::lost);
  EXPECT_EQ(next().what, Capture::lost);
  camera_->give_back(held);
  expect_index_by_time(frame());
}

TEST_F(CameraRuns, IgnoresWhatIsGivenBackThatWasNeverOut) {
  (void)open();
  Captured captured = frame();
  camera_->give_back(captured);
  captured.buffer = 12345;
  camera_->give_back(captured);
  camera_->give_back(Captured{});
  camera_->give_back(next());
  for (int i = 0; i < 20; ++i) (void)frame();
}

}  // namespace
}  // namespace seqloop::live::test
