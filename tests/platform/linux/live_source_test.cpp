// SPDX-License-Identifier: MIT
// The source that joins a capture thread and the work thread, on a camera that acts on command.
#include "seqloop/linux/live_source.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

#include "platform/linux/fake_camera.hpp"
#include "seqloop/linux/steady_clock.hpp"

namespace seqloop::live::test {
namespace {

using std::chrono::milliseconds;

/// A live source on a camera whose acts are written down beforehand; it goes on with good frames.
struct Live {
  explicit Live(std::vector<Act> acts, LiveSettings settings = patient(), bool decodes = true)
      : source(std::make_unique<FakeCamera>(
                   [acts = std::move(acts)](std::uint64_t n) {
                     return n < acts.size() ? acts[static_cast<std::size_t>(n)] : Act::frame;
                   },
                   view, clock, 4294967294U),
               decodes ? std::make_unique<FakeDecoder>() : nullptr, clock, std::move(settings)) {}

  static LiveSettings patient() { return {std::chrono::minutes(5), nullptr, {}}; }

  Grab grab() { return source.grab(frame); }

  CameraView view;
  SteadyClock clock;
  LiveSource source;
  Frame frame;
};

TEST(LiveSource, HandsOverEachFrameWithEverythingThatIsKnownOfIt) {
  Live live({});
  for (std::uint64_t index = 0; index < 5; ++index) {
    live.view.act();
    ASSERT_EQ(live.grab(), Grab::frame);
    EXPECT_EQ(live.frame.index, index);
    EXPECT_EQ(index_in(live.frame.image.data), index);
    EXPECT_EQ(live.frame.sequence, static_cast<std::uint32_t>(4294967294U + index)) << "it wraps";
    EXPECT_DOUBLE_EQ(live.frame.time_s, static_cast<double>(index) / 25.0);
    EXPECT_EQ(live.frame.lost + live.frame.dropped, 0U);
    EXPECT_GT(live.frame.age.count(), 0);
    EXPECT_GT(live.frame.waited.count(), 0);
    EXPECT_TRUE(live.frame.fault.empty());
  }
  EXPECT_FALSE(live.source.frame_count());
}

TEST(LiveSource, WaitsForAFrameThatComesLater) {
  Live live({});
  std::thread later([&] {
    std::this_thread::sleep_for(milliseconds(20));
    live.view.allowed.store(1);
  });
  EXPECT_EQ(live.grab(), Grab::frame);
  EXPECT_GT(live.frame.waited, live.frame.age);
  later.join();
}

TEST(LiveSource, TheNewestFrameIsTakenAndTheOlderOnesCountAsDropped) {
  Live live({});
  live.view.act(5);
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 4U);
  EXPECT_EQ(live.frame.dropped, 4U);
  EXPECT_EQ(live.frame.lost, 0U);
  EXPECT_EQ(live.view.given_back.load(), 4U) << "dropped frames go back at once";
}

TEST(LiveSource, FramesThatTheDeviceLostAreToldApartFromDroppedOnes) {
  Live live({Act::gap, Act::frame, Act::gap, Act::bad, Act::gap});
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 2U);
  EXPECT_EQ(live.frame.lost, 2U) << "before the first frame";
  live.view.act(4);
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 10U);
  EXPECT_EQ(live.frame.lost, 4U);
  EXPECT_EQ(live.frame.dropped, 3U);
  live.source.stop();
  const LiveCounts counts = live.source.counts();
  EXPECT_EQ(counts.delivered, 5U);
  EXPECT_EQ(counts.taken, 2U);
  EXPECT_EQ(counts.dropped, 3U);
  EXPECT_EQ(counts.failed, 0U) << "the bad frame was never taken";
  EXPECT_EQ(counts.lost, 6U);
}

TEST(LiveSource, DamagedAndUndecodableFramesAreUnreadableAndKeepTheirPlace) {
  Live live({Act::frame, Act::bad, Act::undecodable, Act::frame});
  const std::vector<std::string_view> faults = {"", "half of it is missing", "not a JPEG picture",
                                                ""};
  for (std::size_t index = 0; index < faults.size(); ++index) {
    live.view.act();
    EXPECT_EQ(live.grab(), faults[index].empty() ? Grab::frame : Grab::unreadable);
    EXPECT_EQ(live.frame.index, index);
    EXPECT_EQ(live.frame.fault, faults[index]);
    EXPECT_EQ(live.frame.image.data == nullptr, !faults[index].empty());
  }
  EXPECT_EQ(live.source.counts().failed, 2U);
  EXPECT_EQ(live.source.counts().taken, 4U);
}

TEST(LiveSource, WithoutADecoderPicturesAreUnreadable) {
  Live live({}, Live::patient(), false);
  live.view.act();
  EXPECT_EQ(live.grab(), Grab::unreadable);
  EXPECT_EQ(live.frame.fault, "nothing is there to decode pictures with");
}

TEST(LiveSource, SilentAndLostDevicesAreToldAndComeBack) {
  Live live({Act::silent, Act::lost, Act::frame});
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::silent);
  EXPECT_EQ(live.frame.fault, "no frame in time");
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::silent);
  EXPECT_EQ(live.frame.fault, "unplugged");
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 0U) << "silences are no frames";
  EXPECT_EQ(live.source.counts().silences, 2U);
}

TEST(LiveSource, AFrameFromBeforeASilenceGoesFirstOneFromAfterItReplacesIt) {
  LiveSettings settings = Live::patient();
  settings.stop = []() noexcept { return true; };  // `end` wherever a grab would wait
  Live live({Act::frame, Act::silent, Act::lost, Act::frame}, settings);
  live.view.act(2);
  ASSERT_EQ(live.grab(), Grab::frame);
  ASSERT_EQ(live.grab(), Grab::silent);
  live.view.act(2);
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 1U);
  EXPECT_EQ(live.grab(), Grab::end) << "the old silence is over";
  EXPECT_EQ(live.source.counts().silences, 2U) << "it counts all the same";
}

TEST(LiveSource, ARecordingEndsBehindItsLastFrame) {
  Live live({Act::frame, Act::frame, Act::end});
  live.view.allowed.store(always);
  while (live.view.asked.load() < 3) std::this_thread::yield();
  ASSERT_EQ(live.grab(), Grab::frame);
  if (live.frame.index == 0) {
    ASSERT_EQ(live.grab(), Grab::frame);
  }
  EXPECT_EQ(live.frame.index, 1U);
  EXPECT_EQ(live.grab(), Grab::end);
  EXPECT_EQ(live.grab(), Grab::end);
  const LiveCounts counts = live.source.counts();
  EXPECT_EQ(counts.delivered, 2U);
  EXPECT_EQ(counts.delivered, counts.taken + counts.dropped);
}

TEST(LiveSource, HeedsTheStopWhileItWaits) {
  static std::atomic<bool> asked{false};
  asked = false;
  LiveSettings settings = Live::patient();
  settings.stop = []() noexcept { return asked.load(); };
  Live live({}, settings);
  std::thread interruption([] {
    std::this_thread::sleep_for(milliseconds(20));
    asked.store(true);
  });
  EXPECT_EQ(live.grab(), Grab::end);
  interruption.join();
}

TEST(LiveSource, AHangingDeviceIsToldAgainAndAgainUntilItGoesOn) {
  LiveSettings settings;
  settings.hang_timeout = milliseconds(60);
  static std::atomic<bool> hangs{true};
  hangs = true;
  CameraView view;
  view.allowed = always;
  SteadyClock clock;
  LiveSource source(std::make_unique<FakeCamera>(
                        [](std::uint64_t) {
                          while (hangs.load()) std::this_thread::yield();
                          return Act::frame;
                        },
                        view, clock),
                    std::make_unique<FakeDecoder>(), clock, settings);
  Frame frame;
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(source.grab(frame), Grab::silent);
    EXPECT_TRUE(frame.fault.ends_with(" ms it has been asking the device for a frame"));
  }
  hangs = false;
  Grab grab = source.grab(frame);
  while (grab == Grab::silent) grab = source.grab(frame);  // a slow machine may need long
  EXPECT_EQ(grab, Grab::frame);
  EXPECT_GE(source.counts().silences, 2U);
}

TEST(LiveSource, ADeviceThatHangsInTakingAFrameBackIsToldSo) {
  LiveSettings settings;
  settings.hang_timeout = milliseconds(60);
  Live live({}, settings);
  live.view.keeps = true;
  live.view.allowed = 3;  // one of three comes back, however they are taken
  Grab grab = live.grab();
  while (grab == Grab::frame) grab = live.grab();
  EXPECT_EQ(grab, Grab::silent);
  EXPECT_TRUE(live.frame.fault.ends_with("giving a frame back to the device")) << live.frame.fault;
  live.view.keeps = false;
}

TEST(LiveSource, TakesOneOfEveryNIndicesWhenAskedTo) {
  Live live({Act::frame, Act::frame, Act::gap});
  live.source.take_every(3);
  live.view.act(2);  // 0, 1
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 0U);
  live.view.act();  // 4: it stands for 3, which was lost
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 4U);
  EXPECT_EQ(live.frame.dropped, 1U);
  EXPECT_EQ(live.frame.lost, 2U);
  live.view.act(4);  // 5 to 8
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 6U);
  EXPECT_EQ(live.frame.dropped, 1U);
  live.source.take_every(1);
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 9U);
  EXPECT_EQ(live.frame.dropped, 2U);
  live.source.stop();
  const LiveCounts counts = live.source.counts();
  EXPECT_EQ(counts.delivered, 8U);
  EXPECT_EQ(counts.taken, 4U);
  EXPECT_EQ(counts.dropped, 4U);
  EXPECT_EQ(counts.lost, 2U);
}

TEST(LiveSource, NoPatternOfLossesStarvesAThinnedOutReader) {
  // Indices 0, 3, 6 ... and then only such as leave 2 when divided by 3.
  std::vector<Act> acts{Act::frame, Act::frame, Act::frame};
  for (int i = 0; i < 20; ++i) acts.push_back(Act::gap);
  Live live(std::move(acts));
  live.source.take_every(3);
  for (int i = 0; i < 20; ++i) live.view.act();
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_GT(live.frame.index, 40U);
}

TEST(LiveSource, CountsFromTheFirstFrameThatIsTakenWhereAskedTo) {
  LiveSettings settings = Live::patient();
  settings.from_first_taken = true;
  Live live({Act::gap, Act::frame, Act::frame, Act::gap}, settings);
  live.view.act(3);  // 2, 3, 4
  EXPECT_EQ(live.source.counts().delivered, 0U);
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(index_in(live.frame.image.data), 4U);
  EXPECT_EQ(live.frame.index, 0U);
  EXPECT_EQ(live.frame.time_s, 0.0);
  EXPECT_EQ(live.frame.lost + live.frame.dropped, 0U);
  live.view.act();  // 7
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(live.frame.index, 3U);
  EXPECT_EQ(live.frame.lost, 2U);
  live.source.stop();
  EXPECT_EQ(live.source.counts().delivered, 2U);
  EXPECT_EQ(live.source.counts().taken, 2U);
  EXPECT_EQ(live.source.counts().dropped, 0U);
  EXPECT_EQ(live.source.counts().lost, 2U);
}

TEST(LiveSource, StoppingGivesEverythingBackAndCountsWhatWaitsAsDropped) {
  Live live({});
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::frame);
  live.view.act();
  EXPECT_EQ(live.source.counts().dropped, 0U) << "it may still be taken";
  live.source.stop();
  EXPECT_EQ(live.grab(), Grab::end);
  const LiveCounts counts = live.source.counts();
  EXPECT_EQ(counts.delivered, 2U);
  EXPECT_EQ(counts.taken, 1U);
  EXPECT_EQ(counts.dropped, 1U);
  EXPECT_EQ(live.view.out.load(), 0U);
  EXPECT_EQ(live.view.given_back.load(), 2U);
  EXPECT_EQ(live.view.broken_rules.load(), 0U);
}

TEST(LiveSource, KeepsNothingOfADeviceThatIsGone) {
  Live live({Act::frame, Act::frame, Act::lost, Act::lost});
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::frame);
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::frame);
  EXPECT_EQ(index_in(live.frame.image.data), 1U) << "still out: it is being looked at";
  live.view.act();
  ASSERT_EQ(live.grab(), Grab::silent);
  live.view.act();  // the camera is asked once more, and has got everything back before
  EXPECT_EQ(live.view.out.load(), 0U);
  EXPECT_EQ(live.view.broken_rules.load(), 0U);
}

TEST(LiveSource, StartsWithTheSetUpInTheCaptureThread) {
  std::thread::id in;
  LiveSettings settings = Live::patient();
  settings.at_start = [&] { in = std::this_thread::get_id(); };
  const Live live({}, settings);
  EXPECT_NE(in, std::thread::id());
  EXPECT_NE(in, std::this_thread::get_id());
}

TEST(LiveSource, ASetUpThatFailsIsThrownByTheConstructor) {
  LiveSettings settings = Live::patient();
  settings.at_start = [] { throw std::runtime_error("no priority"); };
  EXPECT_THROW(const Live live({}, settings), std::runtime_error);
}

class DescribedDevice : public CaptureDevice {
 public:
  void next(Captured& captured, const std::atomic<bool>& /*stop*/) noexcept override {
    captured = {};
    captured.what = Capture::end;
    if (ended_) return;
    ended_ = true;
    captured.what = Capture::frame;
    captured.descriptor = descriptor_;
  }
  void give_back(const Captured& /*captured*/) noexcept override {}

 private:
  std::array<float, 2> descriptor_{0.6F, 0.8F};
  bool ended_ = false;
};

TEST(LiveSource, DescriptorsNeedNoDecoder) {
  SteadyClock clock;
  LiveSource source(std::make_unique<DescribedDevice>(), nullptr, clock, Live::patient());
  Frame frame;
  ASSERT_EQ(source.grab(frame), Grab::frame);
  ASSERT_EQ(frame.descriptor.size(), 2U);
  EXPECT_EQ(frame.descriptor[1], 0.8F);
  EXPECT_EQ(source.grab(frame), Grab::end);
}

TEST(LiveSource, AtFullSpeedNothingIsTornTwiceOutOfOrderOrKeptBack) {
  constexpr std::uint64_t enough = 20'000;
  constexpr std::uint32_t seed = 7;
  Live live({});
  live.view.allowed.store(always);
  std::mt19937 random(seed);
  std::uint64_t next = 0;
  for (std::uint64_t taken = 0; taken < enough; ++taken) {
    ASSERT_EQ(live.grab(), Grab::frame);
    ASSERT_EQ(live.frame.index, next + live.frame.dropped);
    next = live.frame.index + 1;
    if (random() % 64 == 0) std::this_thread::yield();
    ASSERT_EQ(index_in(live.frame.image.data), live.frame.index) << "seed " << seed;
  }
  live.source.stop();
  EXPECT_LE(live.view.most_out.load(), CaptureDevice::most_out);
  EXPECT_EQ(live.view.broken_rules.load(), 0U);
  EXPECT_EQ(live.view.out.load(), 0U);
  EXPECT_EQ(live.view.frames.load(), live.source.counts().delivered);
  EXPECT_EQ(live.source.counts().delivered,
            live.source.counts().taken + live.source.counts().dropped);
}

}  // namespace
}  // namespace seqloop::live::test
