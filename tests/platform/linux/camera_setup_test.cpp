// SPDX-License-Identifier: MIT
// Opening a camera: what is chosen, and what is said when it cannot be had.
#include <cerrno>
#include <cstring>

#include "expect_setup_error.hpp"
#include "platform/linux/camera_bench.hpp"
#include "seqloop/linux/camera_list.hpp"

namespace seqloop::live::test {
namespace {

using seqloop::test::says;
using seqloop::test::setup_error;

class CameraSetup : public CameraBench {
 protected:
  std::string refused() {
    const std::string message = setup_error([&] { (void)open(); });
    EXPECT_EQ(kernel_.open_files(), 0U);
    EXPECT_EQ(kernel_.mapped(), 0U);
    return message;
  }
};

TEST_F(CameraSetup, TakesTheCheapestModeAndTellsIt) {
  kernel_.plug("/dev/video0");
  const CameraFacts& facts = open().facts();
  EXPECT_EQ(to_string(facts.mode), "YUYV 64x48 at 10 fps");
  EXPECT_EQ(facts.buffers, 6U);
  EXPECT_FALSE(facts.copies);
  EXPECT_EQ(facts.identity.card, "Eye");
  EXPECT_EQ(facts.identity.serial, "1");
  EXPECT_TRUE(kernel_.at("/dev/video0").streaming);
}

TEST_F(CameraSetup, GoesToTheNextModeWhenTheDriverMakesAnotherOfIt) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  camera.offered = {{V4L2_PIX_FMT_GREY, 64, 48, {10}}, {V4L2_PIX_FMT_YUYV, 64, 48, {10}}};
  kernel_.fault = [&](Call call, std::uint64_t) {
    // Listed, but silently turned into the other one.
    if (call == Call::set_format && camera.offered.size() == 2)
      camera.offered.erase(camera.offered.begin());
    return 0;
  };
  EXPECT_EQ(to_string(open().facts().mode), "YUYV 64x48 at 10 fps");
}

TEST_F(CameraSetup, TakesWhatTheDriverGivesWhenNothingComesAsOffered) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  kernel_.fault = [&](Call call, std::uint64_t) {
    if (call == Call::set_format) camera.offered = {{V4L2_PIX_FMT_NV12, 320, 240, {15}}};
    return 0;
  };
  EXPECT_EQ(to_string(open().facts().mode), "NV12 320x240 at 10 fps");
  EXPECT_EQ(frame().picture.bytes.size(), 320U * 240 * 3 / 2);
}

TEST_F(CameraSetup, DoesNotTakeWhatDoesNotServe) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  options_.wish.size = std::pair(64, 48);
  kernel_.fault = [&](Call call, std::uint64_t) {
    if (call == Call::set_format) camera.offered = {{V4L2_PIX_FMT_YUYV, 32, 24, {10}}};
    return 0;
  };
  EXPECT_TRUE(says(refused(), "S_FMT"));
}

TEST_F(CameraSetup, TriesAgainWhatIsRefusedOnce) {
  kernel_.plug("/dev/video0");
  fail(Call::set_format, EINVAL);
  EXPECT_NO_THROW((void)open());
}

TEST_F(CameraSetup, FitsIntoARangeOfSizesAndRates) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  camera.offered = {{V4L2_PIX_FMT_YUYV, 64, 48, {}}};
  camera.size_range = v4l2_frmsize_stepwise{16, 1920, 16, 16, 1080, 8};
  camera.rate_range = v4l2_frmival_stepwise{{1, 60}, {1, 1}, {1, 1}};
  options_.wish = {.least_width = 100, .least_height = 50, .rate = 20};
  EXPECT_EQ(to_string(open().facts().mode), "YUYV 112x56 at 20 fps");
}

TEST_F(CameraSetup, AsksForTheSizeOfADriverThatListsNone) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  camera.lists_sizes = false;
  EXPECT_EQ(to_string(open().facts().mode), "YUYV 64x48 at 10 fps");
}

TEST_F(CameraSetup, StreamsInOnePlaneOfTheMultiPlanarKind) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  camera.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  camera.offered = {{V4L2_PIX_FMT_NV12, 64, 48, {10}}};
  camera.row_padding = 16;
  (void)open();
  const Captured captured = frame();
  EXPECT_EQ(captured.picture.stride, 80U);
  EXPECT_EQ(captured.picture.bytes.size(), 80U * 48 * 3 / 2);
}

TEST_F(CameraSetup, CopiesPicturesOfADriverThatLendsFewBuffers) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  camera.most_buffers = 2;
  EXPECT_TRUE(open().facts().copies);
  std::vector<Captured> held;
  for (std::uint32_t i = 0; i < CaptureDevice::most_out; ++i) held.push_back(next());
  for (std::size_t i = 0; i < held.size(); ++i) {
    ASSERT_EQ(held[i].what, Capture::frame);
    EXPECT_EQ(held[i].picture.bytes.front(), i + 1);
  }
  EXPECT_EQ(next().what, Capture::bad_frame);  // more than may be out
  for (const Captured& captured : held) camera_->give_back(captured);
  EXPECT_EQ(frame().index, 4U);
}

TEST_F(CameraSetup, RefusesAMissingOne) {
  const std::string message = refused();
  EXPECT_TRUE(says(message, "/dev/video0: there is no camera"));
  EXPECT_TRUE(says(message, "No such file"));
}

TEST_F(CameraSetup, RefusesWhatIsNoVideoDevice) {
  kernel_.files = {{"/dev/null", {FileKind::other_device, 0, "root"}},
                   {"/tmp", {FileKind::folder, 0, "root"}},
                   {"/etc/passwd", {FileKind::file, 0, "root"}}};
  for (const auto& [path, word] :
       {std::pair("/dev/null", "a device of another kind"), std::pair("/tmp", "a folder"),
        std::pair("/etc/passwd", "a file")}) {
    options_.path = path;
    EXPECT_TRUE(says(refused(), word));
  }
  EXPECT_EQ(kernel_.count(Call::open), 0U);
}

TEST_F(CameraSetup, SaysHowToGetThePermission) {
  kernel_.plug("/dev/video0");
  fail(Call::open, EACCES, 99);
  const std::string message = refused();
  EXPECT_TRUE(says(message, "belongs to the group video"));
  EXPECT_TRUE(says(message, "sudo usermod -aG video $USER"));
}

TEST_F(CameraSetup, NamesTheNodeThatCapturesWhereThisOneDoesNot) {
  kernel_.plug("/dev/video0").capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  kernel_.plug("/dev/video1");
  FakeCamera other;
  other.bus = "usb-2";
  kernel_.plug("/dev/video2", other);
  const std::string message = refused();
  EXPECT_TRUE(says(message, "takes no pictures"));
  EXPECT_TRUE(says(message, "/dev/video1"));
  EXPECT_EQ(message.find("/dev/video2"), std::string::npos) << message;
}

TEST_F(CameraSetup, ListsTheFormatsThatItCannotRead) {
  kernel_.plug("/dev/video0").offered = {{V4L2_PIX_FMT_H264, 64, 48, {10}}};
  EXPECT_TRUE(says(refused(), "H264 (a format)"));
  kernel_.at("/dev/video0").offered.clear();
  EXPECT_TRUE(says(refused(), "loopback"));
}

TEST_F(CameraSetup, ListsTheSizesWhenTheOneAskedForIsNotThere) {
  kernel_.plug("/dev/video0");
  options_.wish.size = std::pair(100, 100);
  const std::string message = refused();
  EXPECT_TRUE(says(message, "YUYV 64x48, YUYV 32x24, MJPG 128x96"));
}

TEST_F(CameraSetup, WaitsForABusyOneAndSaysWhoHoldsIt) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  camera.owner = 99;
  kernel_.folders = {{"/proc", {"self", "812", "1"}}, {"/proc/812/fd/", {"0", "5"}}};
  kernel_.texts["/proc/812/comm"] = "guvcview";
  kernel_.link("/proc/812/fd/5", "/dev/video0");
  const Nanoseconds begin = clock_.now();
  EXPECT_TRUE(says(refused(), "guvcview (pid 812) uses it"));
  EXPECT_GE(clock_.now() - begin, options_.busy_wait);
  EXPECT_LE(clock_.now() - begin, options_.busy_wait + 1s);
  EXPECT_LT(kernel_.count(Call::set_format), 100U);
  // It comes free while it is waited for.
  kernel_.fault = [&, until = clock_.now() + 2s](Call, std::uint64_t) {
    if (clock_.now() > until) camera.owner = std::min(camera.owner, 98);
    if (camera.owner == 98) camera.owner = -1;
    return 0;
  };
  EXPECT_NO_THROW((void)open());
}

TEST_F(CameraSetup, RefusesWhenTheStreamDoesNotStart) {
  kernel_.plug("/dev/video0");
  fail(Call::stream_on, EIO);
  EXPECT_TRUE(says(refused(), "the driver refused STREAMON: Input/output error"));
}

TEST_F(CameraSetup, RefusesLessThanTwoBuffers) {
  kernel_.plug("/dev/video0").most_buffers = 1;
  EXPECT_TRUE(says(refused(), "fewer than 2 buffers"));
}

TEST_F(CameraSetup, ListsAllDevicesWithTheirLinks) {
  kernel_.plug("/dev/video10");
  kernel_.plug("/dev/video2").capabilities = V4L2_CAP_VIDEO_OUTPUT;
  kernel_.folders["/dev/v4l/by-id/"] = {".", "usb-Eye"};
  kernel_.link("/dev/v4l/by-id/usb-Eye", "/dev/video10");
  const auto cameras = list_cameras(kernel_);
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].path, "/dev/video2");
  EXPECT_TRUE(says(cameras[0].fault, "takes no pictures"));
  EXPECT_EQ(cameras[1].links, std::vector<std::string>{"/dev/v4l/by-id/usb-Eye"});
  EXPECT_EQ(cameras[1].offer.modes.size(), 6U);
  EXPECT_EQ(cameras[1].fault, "");
}

TEST_F(CameraSetup, ListsControlsWithTheirRangesAndValues) {
  FakeCamera& camera = kernel_.plug("/dev/video0");
  const auto control = [](std::uint32_t id, std::uint32_t type, const char* name) {
    v4l2_query_ext_ctrl made{};
    made.id = id;
    made.type = type;
    std::strncpy(made.name, name, sizeof made.name - 1);
    made.minimum = -3;
    made.maximum = 9;
    made.step = 2;
    made.default_value = 5;
    return made;
  };
  camera.controls = {control(10, V4L2_CTRL_TYPE_CTRL_CLASS, "User Controls"),
                     control(11, V4L2_CTRL_TYPE_INTEGER, "Brightness"),
                     control(12, V4L2_CTRL_TYPE_BUTTON, "Press me"),
                     control(13, V4L2_CTRL_TYPE_MENU, "Mode"),
                     control(14, V4L2_CTRL_TYPE_BOOLEAN, "Off")};
  camera.controls[3].minimum = 0;
  camera.controls[3].maximum = 3;
  camera.controls[4].flags = V4L2_CTRL_FLAG_DISABLED;
  const auto controls = list_camera(kernel_, "/dev/video0").controls;
  ASSERT_EQ(controls.size(), 2U);
  EXPECT_EQ(controls[0].name, "Brightness");
  EXPECT_EQ(controls[0].type, "int");
  EXPECT_EQ(controls[0].minimum, -3);
  EXPECT_EQ(controls[0].maximum, 9);
  EXPECT_EQ(controls[0].step, 2);
  EXPECT_EQ(controls[0].preset, 5);
  EXPECT_TRUE(controls[0].readable);
  EXPECT_EQ(controls[0].value, 6);
  EXPECT_EQ(controls[1].items, (std::vector<std::string>{"0: even", "2: even"}));
}

TEST(RealSystemCalls, RefuseWhatIsNoCamera) {
  FakeClock clock;
  for (const auto& [path, word] :
       {std::pair("/dev/null", "a device of another kind"), std::pair("/", "a folder"),
        std::pair("/proc/self/cmdline", "a file"), std::pair("/no/camera", "there is no camera"),
        std::pair("", "there is no camera")}) {
    CameraOptions options;
    options.path = path;
    EXPECT_TRUE(
        says(setup_error([&] { const Camera camera(options, system_calls(), clock); }), word));
  }
}

TEST(RealSystemCalls, ReadSmallFilesAndFolders) {
  SystemCalls& system = system_calls();
  EXPECT_FALSE(system.list_folder("/proc/self").empty());
  EXPECT_TRUE(system.list_folder("/no/folder").empty());
  EXPECT_FALSE(system.read_text("/proc/self/comm").empty());
  EXPECT_EQ(system.read_text("/no/file"), "");
  EXPECT_EQ(system.read_text("/"), "");
  EXPECT_EQ(system.resolve("/proc/self/../self/cwd/..").front(), '/');
  EXPECT_EQ(system.resolve("/no/file"), "");
  EXPECT_EQ(system.open("/no/file").error, ENOENT);
}

TEST(RealSystemCalls, TellTheKernelsOwnError) {
  SystemCalls& system = system_calls();
  EXPECT_EQ(system.ioctl(-1, VIDIOC_QUERYCAP, nullptr), EBADF);
  EXPECT_EQ(system.map(-1, 10, 0).error, EBADF);
}

}  // namespace
}  // namespace seqloop::live::test
