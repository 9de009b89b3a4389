// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace seqloop::live {

/// Makes indices that never go back out of a driver's sequence numbers, which wrap at 2^32, start
/// anew with the stream, or stay 0. Pure: no clock, no memory but its own.
class FrameNumbers {
 public:
  /// @param sequence of the frame after the one before
  /// @return its index, from 0; frames that the device lost in between count
  [[nodiscard]] std::uint64_t index_of(std::uint32_t sequence) noexcept {
    const std::uint32_t step = sequence - last_;  // unsigned: right across the wrap
    // Too far ahead, back, or the same again: the numbers mean nothing, or begin anew.
    const bool goes_on = running_ && step != 0 && step < largest_gap;
    if (goes_on) {
      next_ += step - 1;
      missed_ += step - 1;
    }
    last_ = sequence;
    running_ = true;
    return next_++;
  }

  /// The stream started anew: the next frame follows the last one, whatever its number.
  void restart() noexcept { running_ = false; }

  /// Whether the next frame is the first of a stream, but not the first of all.
  [[nodiscard]] bool starts_anew() const noexcept { return !running_ && next_ > 0; }

  /// Frames that would have come while there was no stream.
  void lose(std::uint64_t frames) noexcept {
    next_ += frames;
    missed_ += frames;
  }

  /// Frames that the device lost, in all.
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  static constexpr std::uint32_t largest_gap = 1U << 20U;  // hours of frames

  std::uint64_t next_ = 0;
  std::uint64_t missed_ = 0;
  std::uint32_t last_ = 0;
  bool running_ = false;
};

}  // namespace seqloop::live
