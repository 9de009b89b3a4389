// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "platform/linux/fake_kernel.hpp"
#include "seqloop/linux/camera.hpp"

namespace seqloop::live::test {

/// A fake kernel with one camera, and a Camera that is opened on it.
class CameraBench : public testing::Test {
 protected:
  void TearDown() override {
    camera_.reset();
    EXPECT_EQ(kernel_.open_files(), 0U);
    EXPECT_EQ(kernel_.mapped(), 0U);
    EXPECT_EQ(kernel_.wrong(), 0U);
  }

  Camera& open() {
    camera_ = std::make_unique<Camera>(options_, kernel_, clock_);
    return *camera_;
  }

  Captured next() {
    Captured captured;
    camera_->next(captured, stop_);
    return captured;
  }

  /// The next good frame, given back; whatever comes before it is let pass.
  Captured frame(int attempts = 100) {
    for (int i = 0; i < attempts; ++i) {
      const Captured captured = next();
      camera_->give_back(captured);
      if (captured.what == Capture::frame) return captured;
    }
    ADD_FAILURE() << "no frame";
    return {};
  }

  /// The first capture of this kind, in a few.
  Captured first(Capture what, int attempts = 100) {
    for (int i = 0; i < attempts; ++i) {
      const Captured captured = next();
      camera_->give_back(captured);
      if (captured.what == what) return captured;
    }
    ADD_FAILURE() << "none came";
    return {};
  }

  /// From now on, this call fails `times` times.
  void fail(Call call, int error, std::uint64_t times = 1) {
    kernel_.fault = [call, error, left = times](Call made, std::uint64_t) mutable {
      if (made != call || left == 0) return 0;
      --left;
      return error;
    };
  }

  FakeClock clock_;
  FakeKernel kernel_{clock_};
  CameraOptions options_{.path = "/dev/video0", .wish = {.least_width = 40, .least_height = 30}};
  std::atomic<bool> stop_{false};
  std::unique_ptr<Camera> camera_;
};

}  // namespace seqloop::live::test
