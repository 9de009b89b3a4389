// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "seqloop/frame.hpp"

namespace seqloop {

/// What a grab brought.
enum class Grab : std::uint8_t {
  frame,       ///< a frame with a picture or a descriptor
  unreadable,  ///< the frame is there but cannot be read; `Frame::fault` says why
  silent,      ///< a live source: no frame came in time; `Frame::fault` says why. Ask again
  end          ///< the drive is over
};

/// Port: where frames come from (image folder, video file, descriptor file, camera).
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  FrameSource(FrameSource&&) = delete;
  FrameSource& operator=(FrameSource&&) = delete;
  virtual ~FrameSource() = default;

  /// Takes the next frame, in order.
  /// @param frame overwritten; its index and time are right for `unreadable` too, and mean nothing
  /// for `silent`. Errors: none thrown. Allocates: may (decoders do).
  [[nodiscard]] virtual Grab grab(Frame& frame) noexcept = 0;

  /// Frames in the whole drive, where that is known beforehand.
  [[nodiscard]] virtual std::optional<std::uint64_t> frame_count() const noexcept = 0;

  /// What a person should know about the drive so far (files left out, sizes that differ, a video
  /// that ended early), one line each. Complete once `grab` brought `end`. Allocates: yes.
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
};

}  // namespace seqloop
