// SPDX-License-Identifier: MIT
// Between two frames, a camera takes no memory, whatever happens to the frames.
#include <cerrno>

#include "core/allocation_guard.hpp"
#include "platform/linux/camera_bench.hpp"

namespace seqloop::live::test {
namespace {

class CameraNoAllocation : public CameraBench {
 protected:
  void SetUp() override {
    if (!AllocationGuard::works()) GTEST_SKIP() << "a sanitizer's heap cannot be counted";
    kernel_.plug("/dev/video0");
    (void)open();
    for (int i = 0; i < 10; ++i) (void)frame();
  }
};

TEST_F(CameraNoAllocation, WhileItStreams) {
  kernel_.at("/dev/video0").edit = [n = 0](v4l2_buffer& buffer) mutable {
    if (++n % 7 == 0) buffer.flags |= V4L2_BUF_FLAG_ERROR;
    if (n % 11 == 0) buffer.sequence += 3;
    if (n % 13 == 0) buffer.timestamp.tv_sec += 5;
  };
  const AllocationGuard guard;
  for (int i = 0; i < 500; ++i) (void)frame();
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_GT(camera_->counters().bad, 50U);
}

TEST_F(CameraNoAllocation, WhileTheStreamIsStartedAnew) {
  int n = 0;
  kernel_.fault = [&n](Call call, std::uint64_t) {
    return call == Call::dequeue && ++n % 5 == 0 ? EIO : 0;
  };
  const AllocationGuard guard;
  for (int i = 0; i < 100; ++i) (void)frame();
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_GT(camera_->counters().restarts, 10U);
}

}  // namespace
}  // namespace seqloop::live::test
