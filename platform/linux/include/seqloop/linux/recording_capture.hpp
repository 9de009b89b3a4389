// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "seqloop/capture_device.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop::live {

/// Plays a recording as if it were a camera: no frame comes before its time, and who is too slow
/// misses frames. The first frame's time is when it has been read.
///
/// While a frame is out, the next one is read. A frame's stamp is the time at which it was due. One
/// that is later than a camera's buffers would have kept it (four frames) is lost, as a camera
/// would have lost it; but never more than nine in a row, since a recording that cannot be read at
/// its own rate would bring nothing then.
class RecordingCapture : public CaptureDevice {
 public:
  /// @param recording, clock live longer; the recording is the capture thread's until that has
  /// ended
  RecordingCapture(FrameSource& recording, Clock& clock) : recording_(&recording), clock_(&clock) {}

  /// Returns after 50 ms at the latest, but for the time that the recording takes to be read.
  /// Allocates: what the recording does; for all buffers at the first picture, and for one whenever
  /// a picture is larger than all before in that buffer.
  void next(Captured& captured, const std::atomic<bool>& stop) noexcept override;

  void give_back(const Captured& captured) noexcept override;

 private:
  struct Buffer {
    std::vector<std::uint8_t> picture;
    std::vector<float> descriptor;
    bool out = false;
  };

  void read_ahead() noexcept;
  [[nodiscard]] bool passes_over() noexcept;
  void keep(const Frame& frame);

  FrameSource* recording_;
  Clock* clock_;
  std::array<Buffer, most_out + 1> buffers_;
  std::optional<Nanoseconds> start_;  // when the recording's second 0 was
  std::optional<Captured> ahead_;     // read, not yet due
  double newest_time_s_ = 0.0;
  std::uint64_t made_ = 0;  // frames, by their numbers
  std::uint64_t delivered_ = 0;
  Nanoseconds last_stamp_{0};
  int passed_over_ = 0;  // in a row
};

}  // namespace seqloop::live
