// SPDX-License-Identifier: MIT
#include "seqloop/linux/recording_capture.hpp"

#include <algorithm>
#include <new>
#include <string_view>
#include <utility>

#include "linux/time_step.hpp"
#include "seqloop/detail/format_fault.hpp"

namespace seqloop::live {
namespace {

std::size_t pixel_bytes(PixelFormat format) noexcept { return format == PixelFormat::bgr8 ? 3 : 1; }

}  // namespace

void RecordingCapture::next(Captured& captured, const std::atomic<bool>& /*stop*/) noexcept {
  captured = {};
  if (!ahead_) read_ahead();
  const Nanoseconds now = clock_->now();
  const bool timed = ahead_->what == Capture::frame || ahead_->what == Capture::bad_frame;
  if (timed) {
    const auto time =
        std::chrono::duration_cast<Nanoseconds>(std::chrono::duration<double>(ahead_->time_s));
    if (!start_) start_ = now - time;
    ahead_->stamp = *start_ + time;
    // Never longer than a time step, whatever the stop says.
    clock_->sleep_until(std::min(ahead_->stamp, now + time_step));
    ahead_->arrived = clock_->now();
    if (ahead_->arrived < ahead_->stamp) return;
    if (passes_over()) return;
    ahead_->delivered = delivered_++;
  }
  captured = *ahead_;
  if (captured.what != Capture::end) ahead_.reset();
}

/// Drops the frame that is ahead where it comes too late.
bool RecordingCapture::passes_over() noexcept {
  constexpr int kept_frames = 4;
  constexpr int most_in_a_row = 9;
  const Nanoseconds interval = ahead_->stamp - std::exchange(last_stamp_, ahead_->stamp);
  const bool late = ahead_->arrived - ahead_->stamp > kept_frames * interval;
  if (!late || ahead_->index == 0 || passed_over_ == most_in_a_row) {
    passed_over_ = 0;
    return false;
  }
  ++passed_over_;
  give_back(*ahead_);
  ahead_.reset();
  return true;
}

void RecordingCapture::give_back(const Captured& captured) noexcept {
  if (captured.what == Capture::frame) buffers_[captured.buffer].out = false;
}

void RecordingCapture::read_ahead() noexcept {
  Frame frame;
  const Grab grab = recording_->grab(frame);
  ahead_.emplace();
  ahead_->index = frame.index;
  ahead_->sequence = static_cast<std::uint32_t>(frame.index);
  ahead_->time_s = newest_time_s_ = std::max(newest_time_s_, frame.time_s);
  ahead_->remark.assign({frame.remark});
  ahead_->fault.assign({frame.fault});
  if (grab == Grab::frame || grab == Grab::unreadable) made_ = frame.index + 1;
  switch (grab) {
    case Grab::end:
      ahead_->what = Capture::end;
      ahead_->index = made_;
      ahead_->delivered = delivered_;
      return;
    case Grab::silent:
      ahead_->what = Capture::silent;
      return;
    case Grab::unreadable:
      ahead_->what = Capture::bad_frame;
      return;
    case Grab::frame:
      break;
  }
  if (const std::string_view fault = format_fault(frame.image.format); !fault.empty()) {
    ahead_->what = Capture::bad_frame;
    ahead_->fault.assign({fault});
    return;
  }
  try {
    keep(frame);
    ahead_->what = Capture::frame;
  } catch (const std::bad_alloc&) {
    ahead_->what = Capture::bad_frame;
    ahead_->fault.assign({"there is no memory for its picture"});
  }
}

void RecordingCapture::keep(const Frame& frame) {
  const Image& image = frame.image;
  const std::size_t row = static_cast<std::size_t>(image.width) * pixel_bytes(image.format);
  const std::size_t bytes = row * static_cast<std::size_t>(image.height);
  // All at the first picture, so that later ones find their memory taken.
  for (Buffer& buffer : buffers_) {
    if (buffer.picture.empty()) buffer.picture.resize(bytes);
    if (buffer.descriptor.empty()) buffer.descriptor.resize(frame.descriptor.size());
  }
  // One is free: at most `most_out` are out.
  const auto free = std::ranges::find(buffers_, false, &Buffer::out);
  if (free->picture.size() < bytes) free->picture.resize(bytes);
  if (free->descriptor.size() < frame.descriptor.size()) {
    free->descriptor.resize(frame.descriptor.size());
  }
  free->out = true;
  ahead_->buffer = static_cast<std::uint32_t>(free - buffers_.begin());
  if (!frame.descriptor.empty()) {
    std::ranges::copy(frame.descriptor, free->descriptor.begin());
    ahead_->descriptor = std::span<const float>(free->descriptor).first(frame.descriptor.size());
    return;
  }
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    std::copy_n(image.data + y * image.stride, row, free->picture.data() + y * row);
  }
  ahead_->picture = {std::span<const std::uint8_t>(free->picture).first(bytes), image.width,
                     image.height, row,
                     image.format == PixelFormat::bgr8 ? RawFormat::bgr8 : RawFormat::gray8};
}

}  // namespace seqloop::live
