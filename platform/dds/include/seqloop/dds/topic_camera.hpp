// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "seqloop/capture_device.hpp"
#include "seqloop/clock.hpp"
#include "seqloop/dds/participant.hpp"

namespace seqloop::dds {

/// What has come of a topic.
struct TopicCounters {
  std::uint64_t frames = 0;         ///< good ones
  std::uint64_t bad = 0;            ///< messages that are no picture that can be read
  std::uint64_t lost = 0;           ///< by the gaps in the headers' stamps
  std::uint64_t silences = 0;       ///< time-outs without a message
  std::uint64_t subscriptions = 0;  ///< times that a publisher was found
};

/// The pictures of a topic of ROS 2 (`sensor_msgs/msg/Image`, `CompressedImage`) as a camera.
///
/// - Nobody publishes: `lost`; publishers are looked for, as long as it takes. Which of the two
///   types, and whether lost packets are sent again, is what the newest publisher offers.
/// - A publisher that comes back is heard again, also with the other type or offer.
/// - No message in time: `silent`.
/// - A message that is none of its type, or too large, or a picture of another encoding:
/// `bad_frame`.
/// - Stamps are the headers'; gaps in them count as lost frames (`FrameTimes`).
///
/// Pictures lie in the memory where DDS has put their packets together until they are given back;
/// nothing is copied. Sizes may change from one picture to the next.
class TopicCamera : public CaptureDevice {
 public:
  /// @param participant, clock live longer   @param topic as ROS 2 names it
  /// @param timeout without a message, after which `next` says so
  /// Throws SetupError: no such topic can be.
  TopicCamera(const Participant& participant, std::string topic, Nanoseconds timeout, Clock& clock);
  TopicCamera(const TopicCamera&) = delete;
  TopicCamera& operator=(const TopicCamera&) = delete;
  TopicCamera(TopicCamera&&) = delete;
  TopicCamera& operator=(TopicCamera&&) = delete;
  ~TopicCamera() override;

  /// Allocates: where a publisher comes; DDS does, for each message.
  void next(Captured& captured, const std::atomic<bool>& stop) noexcept override;
  void give_back(const Captured& captured) noexcept override;

  /// When second 0 was, by the headers, in nanoseconds since 1970; 0 before the first message. Any
  /// thread may ask.
  [[nodiscard]] std::int64_t start_ns() const noexcept {
    return start_ns_.load(std::memory_order_relaxed);
  }

  /// What the headers said at a time, or would have: also before they went back. Any thread may
  /// ask, and waits for nobody. @param time_ns since second 0
  /// @return in nanoseconds since 1970; 0: not known any more, or nothing has come
  [[nodiscard]] std::int64_t stamp_ns(std::int64_t time_ns) const noexcept;

  [[nodiscard]] const TopicCounters& counters() const noexcept { return counters_; }

 private:
  class Ear;

  void look_for_publisher() noexcept;
  [[nodiscard]] bool take(Captured& captured) noexcept;
  [[nodiscard]] bool take_refused(Captured& captured) noexcept;
  void number(Captured& captured) noexcept;
  void time(Captured& captured, std::int64_t stamp_ns) noexcept;
  void tell_absent(Captured& captured) noexcept;
  void tell_silent(Captured& captured) noexcept;

  const Participant& participant_;
  std::string topic_;
  Nanoseconds timeout_;
  Clock& clock_;
  std::unique_ptr<Ear> ear_;
  TopicCounters counters_;
  std::uint64_t refused_ = 0;    // messages, told so far
  Nanoseconds last_message_{0};  // or the start
  double last_time_s_ = 0.0;
  Nanoseconds next_look_{0};
  FixedText absence_;  // why nobody is heard
  std::atomic<std::int64_t> start_ns_{0};
};

}  // namespace seqloop::dds
