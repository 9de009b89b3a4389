// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <latch>
#include <memory>
#include <optional>
#include <thread>

#include "seqloop/capture_device.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/linux/detail/handover.hpp"
#include "seqloop/linux/detail/return_queue.hpp"
#include "seqloop/linux/detail/wake_up.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::live {

struct LiveSettings {
  /// How long the capture thread may do nothing at all before `grab` says so; > 0. Longer than the
  /// device's own time-out, which tells a silent camera.
  Nanoseconds hang_timeout = std::chrono::seconds(5);
  /// Asked every 50 ms while `grab` waits; once it says so, `grab` brings `end`. May be null.
  bool (*stop)() noexcept = nullptr;
  /// What came before the first frame that is taken counts for nothing: a camera delivers while its
  /// user is still being set up.
  bool from_first_taken = false;
  /// Run by the capture thread before anything else: real-time set-up. What it throws, the
  /// constructor of the source throws.
  std::function<void()> at_start = {};
};

/// What became of the frames. `delivered == taken + dropped` once a recording has brought `end`,
/// and after `stop`; before that, frames from after the last taken one are only in `delivered`.
struct LiveCounts {
  std::uint64_t delivered = 0;  ///< frames and bad frames that the device brought
  std::uint64_t taken = 0;      ///< of those, handed over by `grab`
  std::uint64_t dropped = 0;    ///< of those, not handed over: newer ones came, or `take_every`
  std::uint64_t failed = 0;     ///< of the taken, those that were damaged or cannot be decoded
  std::uint64_t lost = 0;       ///< made by the device, but not delivered
  std::uint64_t silences = 0;   ///< silent or lost captures, and time-outs of the capture thread
};

/// A device that does not wait to be asked, as a source of frames: a thread of its own captures,
/// `grab` takes the newest and drops what is older. Pictures stay in the device's memory and are
/// decoded in `grab`, so that a dropped frame costs nothing.
///
/// Everything but the device's `next` and `give_back`, which the capture thread calls, is called by
/// one thread, the work thread.
class LiveSource : public FrameSource {
 public:
  /// Starts the capture thread, and returns when `at_start` has run in it.
  /// @param decoder null where the device brings descriptors
  /// @param clock   lives longer
  /// Errors: SetupError when the system gives no thread or no file descriptor; what `at_start`
  /// throws.
  LiveSource(std::unique_ptr<CaptureDevice> device, std::unique_ptr<PictureDecoder> decoder,
             Clock& clock, LiveSettings settings);
  LiveSource(const LiveSource&) = delete;
  LiveSource& operator=(const LiveSource&) = delete;
  LiveSource(LiveSource&&) = delete;
  LiveSource& operator=(LiveSource&&) = delete;
  ~LiveSource() override;  ///< stops

  /// Waits for the newest frame that has not been taken. `silent` brings what the device says when
  /// it is silent or lost, or that the capture thread hangs, and in what. A silence is not told
  /// when a frame from after it has been taken. `end` comes behind a recording's last frame.
  /// Work: two exchanges and the decoder's; system calls only to wait. Allocates: what the decoder
  /// does. Locks: none.
  [[nodiscard]] Grab grab(Frame& frame) noexcept override;

  [[nodiscard]] std::optional<std::uint64_t> frame_count() const noexcept override { return {}; }

  /// From now on, of every `n` indices takes one; the other frames go back to the device at once
  /// and count as dropped. Any thread may call it. @param n >= 1
  void take_every(std::uint32_t n) noexcept { every_.store(n, std::memory_order_relaxed); }

  /// Ends the capture thread and gives everything back, the frame of the last grab too. Then every
  /// grab brings `end`. Returns as soon as the device's `next` does.
  void stop() noexcept;

  [[nodiscard]] LiveCounts counts() const noexcept;

  /// What the device said at second 0; 0 unless times count from the first frame that was taken.
  [[nodiscard]] double first_time_s() const noexcept { return first_time_s_; }

 private:
  enum class Doing : std::uint8_t { asking_for_a_frame, giving_back };

  void capture() noexcept;
  [[nodiscard]] bool pass_on(Captured& captured) noexcept;
  void drop(Captured& captured) noexcept;
  void pass_on_event(const Captured& captured) noexcept;
  void give_back(Captured& captured) noexcept;
  void take_back_finished() noexcept;
  void finish_with_last() noexcept;
  [[nodiscard]] Grab take_up(Frame& frame, Nanoseconds began) noexcept;
  [[nodiscard]] Grab tell_hang(Frame& frame, Nanoseconds since) noexcept;

  std::unique_ptr<CaptureDevice> device_;
  std::unique_ptr<PictureDecoder> decoder_;
  Clock* clock_;
  LiveSettings settings_;

  Handover<Captured> frames_;  // frames and bad frames
  Handover<Captured> events_;  // the rest, so that no event takes a frame's place
  // Between two grabs' waits the reader holds nothing, so that a device that is gone can let go of
  // its memory and be opened anew. While the writer sleeps, the reader finishes with two at most.
  ReturnQueue<Captured, 4> finished_;
  WakeUp wake_up_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::uint32_t> every_{1};
  std::atomic<Doing> doing_{Doing::asking_for_a_frame};
  std::atomic<std::uint64_t> rounds_{0};  // of the capture thread: it hangs when they stand still
  std::atomic<std::uint64_t> delivered_{0};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<std::uint64_t> silences_{0};

  // The capture thread's.
  std::uint64_t take_from_ = 0;  // index from which on the next frame is taken
  FixedText untold_;             // remarks of frames that were dropped

  // The work thread's.
  std::uint64_t next_index_ = 0;       // of the frame after the last taken, were none missing
  std::uint64_t next_delivered_ = 0;   // likewise
  std::uint64_t first_index_ = 0;      // of the first taken, where all counts from there
  std::uint64_t first_delivered_ = 0;  // likewise
  double first_time_s_ = 0.0;          // likewise
  bool event_waits_ = false;           // in events_.reading(), not told yet
  FixedText hang_;
  std::uint64_t taken_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t failed_ = 0;
  std::uint64_t hangs_ = 0;

  std::latch started_{1};
  std::exception_ptr start_fault_;
  std::thread thread_;
};

}  // namespace seqloop::live
