// SPDX-License-Identifier: MIT
// Every error at every call: no crash, no leak, no spinning, and recovery.
#include <array>
#include <cerrno>
#include <cstdint>
#include <random>

#include "platform/linux/camera_bench.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::live::test {
namespace {

constexpr std::array errors = {EIO,    EINVAL, ENODEV, EBUSY, EACCES, ENOMEM,
                               EAGAIN, EINTR,  EPERM,  ENXIO, ENOTTY, EMFILE};
// Twice in a second the device may be sought: every node is opened, then one is set up.
constexpr std::uint64_t most_calls_of_next = 600;

class CheckedCamera : public CameraBench {
 protected:
  /// What is promised of every capture, whatever happens.
  Captured checked_next() {
    const std::uint64_t before = kernel_.total_calls();
    const Nanoseconds begin = clock_.now();
    const Captured captured = next();
    EXPECT_LT(kernel_.total_calls() - before, most_calls_of_next);
    EXPECT_LT(clock_.now() - begin, 2s);
    const bool counted = captured.what == Capture::frame || captured.what == Capture::bad_frame;
    if (counted) {
      EXPECT_EQ(captured.delivered, delivered_++);
      EXPECT_GE(captured.index, next_index_);
      next_index_ = captured.index + 1;
      EXPECT_LE(captured.stamp, captured.arrived);
      EXPECT_GE(captured.time_s, time_s_);
      time_s_ = captured.time_s;
    }
    EXPECT_EQ(captured.fault.empty(),
              captured.what == Capture::frame || captured.what == Capture::nothing);
    EXPECT_EQ(captured.picture.bytes.empty(), captured.what != Capture::frame);
    const CameraCounters counters = camera_->counters();
    EXPECT_EQ(counters.frames + counters.bad, delivered_);
    if (counted) {
      EXPECT_EQ(next_index_, delivered_ + counters.missed);
    }
    return captured;
  }

  std::uint64_t delivered_ = 0;
  std::uint64_t next_index_ = 0;
  double time_s_ = 0.0;
};

class EveryFault : public CheckedCamera, public testing::WithParamInterface<std::size_t> {
 protected:
  [[nodiscard]] static Call call() { return static_cast<Call>(GetParam()); }

  void open_with(int error, std::uint64_t nth);
  void run_with(int error, std::uint64_t after, std::uint64_t times);
};

/// The nth call of the kind fails, and all after it.
void EveryFault::open_with(int error, std::uint64_t nth) {
  FakeKernel kernel(clock_);
  kernel.plug("/dev/video0");
  kernel.plug("/dev/video1").capabilities = V4L2_CAP_VIDEO_OUTPUT;
  kernel.fault = [&](Call made, std::uint64_t count) {
    return made == call() && count >= nth ? error : 0;
  };
  try {
    const Camera camera(options_, kernel, clock_);
  } catch (const SetupError& refused) {
    EXPECT_NE(std::string(refused.what()).find("/dev/video0: "), std::string::npos);
  }
  EXPECT_EQ(kernel.open_files(), 0U);
  EXPECT_EQ(kernel.mapped(), 0U);
  EXPECT_EQ(kernel.wrong(), 0U);
  EXPECT_LT(kernel.total_calls(), 20'000U);
}

/// Some calls of the kind fail, in a camera that is silent for a while besides: most calls are
/// only made to set it up again.
void EveryFault::run_with(int error, std::uint64_t after, std::uint64_t times) {
  delivered_ = next_index_ = 0;
  time_s_ = 0.0;
  camera_.reset();
  kernel_.plug("/dev/video0");
  (void)open();
  for (int i = 0; i < 3; ++i) camera_->give_back(checked_next());
  kernel_.fault = [&, seen = std::uint64_t{0}](Call made, std::uint64_t) mutable {
    if (made != call() || seen++ < after) return 0;
    return seen <= after + times ? error : 0;
  };
  kernel_.at("/dev/video0").silent = true;
  std::vector<Captured> held;
  for (int i = 0; i < 9; ++i) held.push_back(checked_next());
  for (const Captured& captured : held) camera_->give_back(captured);
  kernel_.at("/dev/video0").silent = false;
  for (int i = 0; i < 12; ++i) camera_->give_back(checked_next());
  kernel_.fault = nullptr;
  int good = 0;
  for (int i = 0; i < 20 && good < 5; ++i) {
    const Captured captured = checked_next();
    good += captured.what == Capture::frame ? 1 : 0;
    camera_->give_back(captured);
  }
  EXPECT_EQ(good, 5);
  EXPECT_LE(kernel_.open_files(), 1U);
  EXPECT_LE(kernel_.mapped(), 6U);
}

TEST_P(EveryFault, WhileOpeningIsASetupErrorOrNothing) {
  for (const int error : errors) {
    for (std::uint64_t nth = 0; nth < 8 && !HasFailure(); ++nth) {
      SCOPED_TRACE(testing::Message() << "errno " << error << " from call " << nth);
      open_with(error, nth);
    }
  }
}

TEST_P(EveryFault, WhileRunningGoesAwayWithTheFault) {
  for (const int error : errors) {
    for (const std::uint64_t times : {1U, 2U, 3U, 50U, 100'000U}) {
      for (std::uint64_t after = 0; after < 5 && !HasFailure(); ++after) {
        SCOPED_TRACE(testing::Message()
                     << "errno " << error << ", " << times << " times after " << after);
        run_with(error, after, times);
      }
    }
  }
}

constexpr std::array call_names = {
    "open",        "queryCapability", "listFormats", "listSizes",    "listRates",
    "setFormat",   "getFormat",       "tryFormat",   "setRate",      "getRate",
    "subscribe",   "requestBuffers",  "queryBuffer", "map",          "queue",
    "streamOn",    "streamOff",       "dequeue",     "dequeueEvent", "queryControl",
    "readControl", "queryMenu",       "poll"};
static_assert(call_names.size() == calls);

INSTANTIATE_TEST_SUITE_P(At, EveryFault, testing::Range(std::size_t{0}, calls),
                         [](const auto& one) { return std::string(call_names.at(one.param)); });

/// Some 20,000 captures with faults of all kinds in any order, frames held and given back at will.
TEST_F(CheckedCamera, KeepsItsPromisesUnderRandomFaults) {
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto one_in = [&random](unsigned chances) { return random() % chances == 0; };
    delivered_ = next_index_ = 0;
    time_s_ = 0.0;
    kernel_.fault = nullptr;
    camera_.reset();
    FakeCamera device;
    device.orphans = seed % 2 == 0;
    device.most_buffers = seed < 3 ? 32 : 3;
    kernel_.plug("/dev/video0", device);
    (void)open();
    std::string path = "/dev/video0";
    std::shared_ptr<FakeCamera> unplugged;
    bool rough = false;
    kernel_.fault = [&](Call, std::uint64_t) {
      return one_in(rough ? 4 : 400) ? errors[random() % errors.size()] : 0;
    };
    struct Held {
      Captured captured;
      std::uint8_t shade;
    };
    std::vector<Held> held;
    std::uint64_t good = 0;
    for (int i = 0; i < 5000; ++i) {
      if (one_in(50)) rough = !rough;
      if (unplugged && one_in(5)) {
        path = one_in(2) ? "/dev/video0" : "/dev/video4";
        kernel_.replug(path, std::exchange(unplugged, nullptr));
      } else if (!unplugged && one_in(200)) {
        unplugged = kernel_.pull(path);
      }
      if (!unplugged) {
        FakeCamera& camera = kernel_.at(path);
        if (one_in(100)) camera.silent = !camera.silent;
        if (one_in(100)) camera.events = 1;
        if (one_in(100)) camera.mode.width ^= 32U;
        if (one_in(100)) camera.stamp_flag ^= V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
        camera.edit = nullptr;
        if (one_in(20)) {
          camera.edit = [&random](v4l2_buffer& b) {
            const auto value = static_cast<std::uint32_t>(random());
            switch (random() % 5) {
              case 0:
                b.bytesused = value % 10'000;
                break;
              case 1:
                b.flags ^= value;
                break;
              case 2:
                b.index = 32 + value % 40;  // a lie that cannot be seen through cannot be survived
                break;
              case 3:
                b.sequence = value;
                break;
              default:
                b.timestamp.tv_sec = value % 3000;
            }
          };
        }
      }
      const Captured captured = checked_next();
      if (captured.what == Capture::frame) {
        ++good;
        held.push_back({captured, captured.picture.bytes.front()});
      }
      for (const Held& frame : held) {  // nobody writes into what is out
        ASSERT_EQ(frame.captured.picture.bytes.front(), frame.shade);
        ASSERT_EQ(frame.captured.picture.bytes.back(), frame.shade);
      }
      while (held.size() >= CaptureDevice::most_out || (!held.empty() && one_in(2))) {
        const std::size_t which = random() % held.size();
        camera_->give_back(held[which].captured);
        held.erase(held.begin() + static_cast<std::ptrdiff_t>(which));
      }
      ASSERT_LE(camera_->retired(), CaptureDevice::most_out);
      ASSERT_LE(kernel_.open_files(), 1U);
      ASSERT_FALSE(HasFailure()) << "capture " << i;
    }
    EXPECT_GT(good, 500U);
    RecordProperty("good_frames_" + std::to_string(seed), std::to_string(good));
    kernel_.fault = nullptr;
    for (const Held& frame : held) camera_->give_back(frame.captured);
    if (unplugged) kernel_.replug("/dev/video0", unplugged);
    camera_.reset();
    if (kernel_.resolve("/dev/video0").empty()) continue;
    (void)kernel_.pull("/dev/video0");
  }
}

}  // namespace
}  // namespace seqloop::live::test
