// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "seqloop/clock.hpp"
#include "seqloop/fixed_text.hpp"
#include "seqloop/raw_picture.hpp"

namespace seqloop {

/// What a capture brought.
enum class Capture : std::uint8_t {
  frame,      ///< a picture, or a descriptor
  bad_frame,  ///< a frame that the device itself says is damaged, or that is; `fault` says why
  silent,     ///< no frame within the time-out; `fault` says since when
  lost,       ///< the device is gone or cannot be opened, and is being looked for; `fault` says why
  nothing,    ///< nothing yet, before the time-out; ask again
  end         ///< a recording is over
};

/// What a capture device hands over. Holds no memory of its own but the message.
struct Captured {
  Capture what = Capture::nothing;
  RawPicture picture;                 ///< of a frame; empty where it comes with a descriptor
  std::span<const float> descriptor;  ///< [D], when the recording was described before
  std::uint64_t index = 0;      ///< frames that the device has made before this one, from 0; those
                                ///< that it lost count, so that indices have gaps
  std::uint64_t delivered = 0;  ///< frames and bad frames that `next` has brought before this one
  std::uint32_t sequence = 0;   ///< the device's own number; it may wrap and start anew
  Nanoseconds stamp{0};         ///< when the picture was taken, on the clock; never after `arrived`
  Nanoseconds arrived{0};       ///< when `next` got it, on the clock
  double time_s = 0.0;          ///< seconds since the first frame, never going back
  FixedText fault;              ///< of `bad_frame`, `silent`, `lost`
  FixedText remark;             ///< of a frame that is good all the same: its time stamp jumped ...
  std::uint32_t buffer = 0;     ///< the device's own
};

/// Port: what a capture thread asks for frames. `next` and `give_back` are called by one thread.
class CaptureDevice {
 public:
  CaptureDevice() = default;
  CaptureDevice(const CaptureDevice&) = delete;
  CaptureDevice& operator=(const CaptureDevice&) = delete;
  CaptureDevice(CaptureDevice&&) = delete;
  CaptureDevice& operator=(CaptureDevice&&) = delete;
  virtual ~CaptureDevice() = default;

  /// The most captures that may be held at a time without being given back.
  static constexpr std::uint32_t most_out = 3;

  /// Waits for the next frame, not much longer than the device's time-out.
  /// @param captured overwritten. What it points to stays valid until it is given back
  /// @param stop     once it is true, the call returns within 50 ms
  /// Errors: none thrown; whatever happens to the device is told in `captured`, and the next calls
  /// try to get it back. Allocates: never between two frames; opening a device anew may.
  virtual void next(Captured& captured, const std::atomic<bool>& stop) noexcept = 0;

  /// Takes back the memory of a `frame` or `bad_frame`; of anything else, does nothing.
  virtual void give_back(const Captured& captured) noexcept = 0;
};

}  // namespace seqloop
