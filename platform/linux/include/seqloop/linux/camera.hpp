// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "seqloop/capture_device.hpp"
#include "seqloop/clock.hpp"
#include "seqloop/linux/camera_mode.hpp"
#include "seqloop/linux/detail/capture_stream.hpp"
#include "seqloop/linux/detail/find_camera.hpp"
#include "seqloop/linux/detail/frame_numbers.hpp"
#include "seqloop/linux/detail/frame_stamps.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// Which camera, and how it is run.
struct CameraOptions {
  std::string path = "/dev/video0";  ///< or a link to it, such as /dev/v4l/by-id/...
  CameraWish wish;
  Nanoseconds timeout = std::chrono::seconds(1);  ///< without a frame, after which `next` says so
  Nanoseconds retry_interval = std::chrono::milliseconds(500);  ///< while a lost camera is sought
  Nanoseconds busy_wait = std::chrono::seconds(5);  ///< for another program, when opened first
  std::uint32_t buffers = 6;  ///< asked for, 2 .. 32; drivers may lend fewer or more
};

/// What has happened since the camera was opened.
struct CameraCounters {
  std::uint64_t frames = 0;      ///< good ones
  std::uint64_t bad = 0;         ///< damaged ones
  std::uint64_t missed = 0;      ///< gaps in the device's numbers, and what would have come while
                                 ///< there was no stream
  std::uint64_t silences = 0;    ///< time-outs without a frame
  std::uint64_t restarts = 0;    ///< of the stream, on the same device
  std::uint64_t reopenings = 0;  ///< of the device
  std::uint64_t losses = 0;      ///< times that the device could not be opened again at once
  std::array<std::uint64_t, odd_stamp_kinds> odd_stamps{};  ///< by OddStamp
};

/// What the camera is and does at the moment.
struct CameraFacts {
  std::string path;  ///< that it was found under
  CameraIdentity identity;
  CameraMode mode;  ///< as the driver gave it; rate 0 where it does not say
  std::size_t buffers = 0;
  bool copies = false;  ///< pictures are copied, because the driver lends too few buffers
};

/// A V4L2 camera that heals itself.
///
/// - No frame in time: `silent`; after 3 the stream is started anew, after 6, 12, ... it is opened
///   anew. Likewise where only damaged frames come.
/// - Waiting or taking a frame fails: the stream is started anew; if that is not enough, opened
/// anew.
/// - The device is gone: `lost`; it is looked for, also under other names (`find_camera`).
/// - Another format behind our back: opened anew, in the mode that is the best now.
/// - A damaged, short or empty frame: `bad_frame`; it counts as a frame.
/// - Odd time stamps: the time of arrival instead; a remark when that begins.
///
/// Frames that would have come while there was no stream count as lost, by the time that has gone
/// by. A device that fails again before it brought a good frame is tried again once in the retry
/// interval, for ever. What was done is told in the next frame's remark. Frames that are out stay
/// readable, whatever becomes of the device.
class Camera : public CaptureDevice {
 public:
  /// Opens the camera and lets it run.
  /// Throws SetupError: no such device, not permitted, no camera, nothing that serves the wish,
  /// busy for longer than `busy_wait`, or what the driver refused.
  /// @param system, clock live as long as the camera; the clock is CLOCK_MONOTONIC
  Camera(CameraOptions options, SystemCalls& system, Clock& clock);

  /// Polls in time steps of at most 50 ms. While opening anew it waits for the driver, which may
  /// take longer.
  void next(Captured& captured, const std::atomic<bool>& stop) noexcept override;
  void give_back(const Captured& captured) noexcept override;

  [[nodiscard]] CameraCounters counters() const noexcept;

  /// Of the last time that the camera was there. Changes when it is opened anew.
  [[nodiscard]] const CameraFacts& facts() const noexcept { return facts_; }

  /// Streams that are no longer used and wait for frames that are out.
  [[nodiscard]] std::size_t retired() const noexcept { return retired_.size(); }

 private:
  struct Retired {
    std::uint32_t generation;
    std::unique_ptr<CaptureStream> stream;
  };

  void open_first();
  [[nodiscard]] bool reopen() noexcept;
  void take_up(std::unique_ptr<CaptureStream> stream);
  void retire() noexcept;
  void trouble(std::string_view doing, int error) noexcept;
  void lose(std::string_view why) noexcept;
  void restart_or_lose(std::string_view why) noexcept;
  [[nodiscard]] bool capture(Captured& captured, Nanoseconds deadline) noexcept;
  [[nodiscard]] bool take_frame(Captured& captured, bool broken) noexcept;
  void fill(Captured& captured, const Dequeued& taken) noexcept;
  [[nodiscard]] std::uint64_t frames_between(Nanoseconds before, Nanoseconds after) const noexcept;
  void tell_silent(Captured& captured) noexcept;
  void act_on_silence(std::string_view why) noexcept;
  void tell_lost(Captured& captured, Nanoseconds now) noexcept;
  void remark(std::string_view text) noexcept;
  void pause(Nanoseconds until) noexcept;

  CameraOptions options_;
  SystemCalls& system_;
  Clock& clock_;
  CameraFacts facts_;
  CameraCounters counters_;
  FrameNumbers numbers_;
  FrameStamps stamps_;
  std::unique_ptr<CaptureStream> stream_;  ///< none while the device is lost
  std::vector<Retired> retired_;
  std::uint32_t generation_ = 0;  ///< of the stream, so that frames find back to theirs
  Twins twins_;

  // Since the last good frame.
  std::uint32_t troubles_ = 0;
  std::uint64_t silences_ = 0;
  std::uint64_t silences_to_act_ = 0;  ///< at which the stream is started or opened anew
  Nanoseconds last_frame_{0};          ///< or the start

  Nanoseconds lost_since_{0};
  Nanoseconds next_attempt_{0};
  bool loss_untold_ = false;
  FixedText loss_;    ///< why the device was given up
  FixedText remark_;  ///< for the next frame
  Nanoseconds first_stamp_{-1};
  Nanoseconds last_stamp_{0};
};

}  // namespace seqloop::live
