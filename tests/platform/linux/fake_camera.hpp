// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>
#include <utility>

#include "seqloop/capture_device.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::live::test {

/// What a fake camera does when it is asked.
enum class Act : std::uint8_t { frame, gap, bad, undecodable, silent, lost, end };

constexpr std::uint64_t frames_in_gap = 2;  // lost before the frame that `gap` brings
constexpr std::uint64_t always = std::numeric_limits<std::uint64_t>::max();

/// The test's window into a camera that another thread owns and uses.
struct CameraView {
  std::atomic<std::uint64_t> allowed{0};  ///< acts that the camera may do in all
  std::atomic<std::uint64_t> asked{0};    ///< acts that it was asked for
  std::atomic<std::uint64_t> frames{0};   ///< brought, bad ones too
  std::atomic<std::uint64_t> lost{0};
  std::atomic<std::uint64_t> silences{0};  ///< silent and lost
  std::atomic<std::uint64_t> given_back{0};
  std::atomic<std::uint32_t> out{0};
  std::atomic<std::uint32_t> most_out{0};
  std::atomic<std::uint64_t> broken_rules{0};  ///< given back twice, or what never was out
  std::atomic<bool> keeps{false};              ///< giving back hangs

  /// Lets the camera do this many more acts, and returns when the capture thread is done with them.
  void act(std::uint64_t more = 1) {
    const std::uint64_t all = allowed.load() + more;
    allowed.store(all);
    while (asked.load() <= all) std::this_thread::yield();
  }
};

/// A camera with as few buffers as the port allows, whose frames say which they are.
class FakeCamera : public CaptureDevice {
 public:
  static constexpr std::size_t side = 8;  // pixels; a picture is its index in every row

  /// @param script called by the capture thread for the n-th act, from 0
  FakeCamera(std::function<Act(std::uint64_t)> script, CameraView& view, Clock& clock,
             std::uint32_t first_sequence = 0)
      : script_(std::move(script)), view_(&view), clock_(&clock), sequence_(first_sequence) {}

  void next(Captured& captured, const std::atomic<bool>& stop) noexcept override {
    captured = {};
    view_->asked.store(act_ + 1);
    while (act_ >= view_->allowed.load()) {
      if (stop.load()) return;
      std::this_thread::yield();
    }
    switch (const Act act = script_(act_++)) {
      case Act::silent:
      case Act::lost:
        captured.what = act == Act::silent ? Capture::silent : Capture::lost;
        captured.fault.assign({act == Act::silent ? "no frame in time" : "unplugged"});
        view_->silences.fetch_add(1);
        return;
      case Act::end:
        captured.what = Capture::end;
        return;
      default:
        if (act == Act::gap) {
          index_ += frames_in_gap;
          view_->lost.fetch_add(frames_in_gap);
        }
        bring(captured, act);
    }
  }

  void give_back(const Captured& captured) noexcept override {
    while (view_->keeps.load()) std::this_thread::yield();
    Buffer& buffer = buffers_[captured.buffer];
    if (!buffer.out || buffer.index != captured.index) view_->broken_rules.fetch_add(1);
    buffer.out = false;
    buffer.bytes.fill(0xEE);  // whoever still looks at it sees that
    view_->given_back.fetch_add(1);
    view_->out.fetch_sub(1);
  }

 private:
  struct Buffer {
    std::array<std::uint8_t, side * side> bytes{};
    std::uint64_t index = 0;
    bool out = false;
  };

  void bring(Captured& captured, Act act) noexcept {
    const std::uint32_t out = view_->out.fetch_add(1) + 1;
    if (out > view_->most_out.load()) view_->most_out.store(out);
    std::uint32_t free = 0;
    while (buffers_[free].out && free + 1 < buffers_.size()) ++free;
    Buffer& buffer = buffers_[free];
    buffer.out = true;
    buffer.index = index_;
    for (std::size_t row = 0; row < side; ++row) {
      std::memcpy(buffer.bytes.data() + row * side, &index_, sizeof index_);
    }
    captured.what = act == Act::bad ? Capture::bad_frame : Capture::frame;
    if (act == Act::bad) captured.fault.assign({"half of it is missing"});
    captured.picture = {buffer.bytes, side, side, side,
                        act == Act::undecodable ? RawFormat::mjpg : RawFormat::gray8};
    captured.buffer = free;
    captured.delivered = view_->frames.fetch_add(1);
    captured.sequence = sequence_ + static_cast<std::uint32_t>(index_);
    captured.time_s = static_cast<double>(index_) / 25.0;
    captured.stamp = clock_->now();
    captured.arrived = clock_->now();
    captured.index = index_++;
  }

  std::function<Act(std::uint64_t)> script_;
  CameraView* view_;
  Clock* clock_;
  std::uint32_t sequence_;
  std::uint64_t act_ = 0;
  std::uint64_t index_ = 0;
  std::array<Buffer, most_out + 1> buffers_{};
};

/// The frame that a fake camera's picture shows; `always` when its rows do not agree.
inline std::uint64_t index_in(const std::uint8_t* bytes) noexcept {
  std::uint64_t index = 0;
  std::memcpy(&index, bytes, sizeof index);
  for (std::size_t row = 1; row < FakeCamera::side; ++row) {
    if (std::memcmp(bytes, bytes + row * FakeCamera::side, sizeof index) != 0) return always;
  }
  return index;
}

/// Looks at the picture where it lies.
class FakeDecoder : public PictureDecoder {
 public:
  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override {
    if (raw.format == RawFormat::mjpg) return "not a JPEG picture";
    image = {raw.bytes.data(), raw.width, raw.height, raw.stride, PixelFormat::gray8};
    return {};
  }
};

}  // namespace seqloop::live::test
