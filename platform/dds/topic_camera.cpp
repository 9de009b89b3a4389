// SPDX-License-Identifier: MIT
#include "seqloop/dds/topic_camera.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "dds/frame_times.hpp"
#include "dds/subscription.hpp"
#include "ros/pictures.hpp"
#include "ros/wall_time.hpp"

namespace seqloop::dds {
namespace {

using Milliseconds = std::chrono::milliseconds;

constexpr Nanoseconds time_step = Milliseconds(50);
constexpr Nanoseconds look_interval = Milliseconds(100);
constexpr std::int32_t depth = 30;  // messages that wait while the capture thread is kept away
constexpr std::uint32_t no_buffer = ~0U;

void append_milliseconds(FixedText& text, Nanoseconds time) noexcept {
  text.append_number(static_cast<std::uint64_t>(time / Milliseconds(1)));
  text.append(" ms");
}

}  // namespace

/// What outlives a subscription, and the subscription.
class TopicCamera::Ear {
 public:
  std::optional<Subscription> subscription;
  Offer heard;  // of whom it was made for
  ros::PictureType type = ros::PictureType::none;
  FrameTimes times;
  std::array<Message, most_out + 1> out;
};

TopicCamera::TopicCamera(const Participant& participant, std::string topic, Nanoseconds timeout,
                         Clock& clock)
    : participant_(participant),
      topic_(std::move(topic)),
      timeout_(timeout),
      clock_(clock),
      ear_(std::make_unique<Ear>()),
      last_message_(clock.now()) {
  check_topic(topic_, "source");
  refused_ = participant_.refused(topic_);
}

TopicCamera::~TopicCamera() = default;

void TopicCamera::next(Captured& captured, const std::atomic<bool>& stop) noexcept {
  captured = {};
  captured.buffer = no_buffer;
  const Nanoseconds deadline = clock_.now() + timeout_;
  while (!stop.load()) {
    if (take_refused(captured) || take(captured)) return;
    const Nanoseconds now = clock_.now();
    const bool heard = ear_->subscription && ear_->subscription->publishers() > 0;
    if (!heard && now >= next_look_) look_for_publisher();
    if (now >= deadline) return heard ? tell_silent(captured) : tell_absent(captured);
    if (ear_->subscription) {
      ear_->subscription->wait(std::min(time_step, deadline - now));
    } else {
      clock_.sleep_until(std::min(deadline, now + time_step));
    }
  }
}

/// Listens to the newest publisher, unless it does so already.
void TopicCamera::look_for_publisher() noexcept {
  next_look_ = clock_.now() + look_interval;
  try {
    const std::optional<Offer> offer = participant_.offer(topic_);
    if (!offer) {
      absence_.assign({"nobody publishes ", topic_});
      return;
    }
    if (ear_->subscription && ear_->heard == *offer) return;
    const ros::PictureType type = ros::picture_type(offer->type);
    if (type == ros::PictureType::none) {
      absence_.assign(
          {topic_, " is ", offer->type, ", not sensor_msgs/msg/Image or CompressedImage"});
      return;
    }
    ear_->subscription.reset();
    ear_->subscription.emplace(participant_, topic_, topic_type(offer->type), offer->reliable,
                               depth);
    ear_->heard = *offer;
    ear_->type = type;
    ++counters_.subscriptions;
    absence_.assign({"the publisher of ", topic_, " does not answer"});
  } catch (const std::exception& error) {  // try again later
    absence_.assign({topic_, " cannot be listened to: ", error.what()});
  }
}

bool TopicCamera::take_refused(Captured& captured) noexcept {
  if (participant_.refused(topic_) == refused_) return false;
  ++refused_;
  number(captured);
  captured.stamp = captured.arrived;
  ++counters_.bad;
  captured.what = Capture::bad_frame;
  captured.fault.assign({"a message on ", topic_, " is not of its type, or too large"});
  return true;
}

bool TopicCamera::take(Captured& captured) noexcept {
  if (!ear_->subscription) return false;
  Message message = ear_->subscription->take();
  if (message.bytes().empty()) return false;
  ros::PictureMessage read = ros::read_picture(ear_->type, message.bytes(), captured.fault);
  number(captured);
  time(captured, read.stamp_ns);
  if (!captured.fault.empty()) {
    ++counters_.bad;
    captured.what = Capture::bad_frame;
    return true;
  }
  // One is free: at most `most_out` are out.
  const auto free =
      std::ranges::find_if(ear_->out, [](const Message& held) { return held.bytes().empty(); });
  *free = std::move(message);
  captured.buffer = static_cast<std::uint32_t>(free - ear_->out.begin());
  captured.picture = read.picture;
  captured.what = Capture::frame;
  ++counters_.frames;
  return true;
}

/// Says which message it is.
void TopicCamera::number(Captured& captured) noexcept {
  captured.arrived = last_message_ = clock_.now();
  captured.delivered = counters_.frames + counters_.bad;
  captured.index = captured.delivered + counters_.lost;
  captured.sequence = static_cast<std::uint32_t>(captured.index);
  captured.time_s = last_time_s_;
}

/// Says when it was taken, and what is missing before it.
void TopicCamera::time(Captured& captured, std::int64_t stamp_ns) noexcept {
  const FrameTimes::Judged judged = ear_->times.judge(stamp_ns, captured.arrived, ros::wall_ns());
  start_ns_.store(ear_->times.start_ns(), std::memory_order_relaxed);
  counters_.lost += judged.lost;
  captured.index += judged.lost;
  captured.sequence = static_cast<std::uint32_t>(captured.index);
  captured.stamp = judged.stamp;
  captured.time_s = last_time_s_ = judged.time_s;
  captured.remark.assign({judged.remark});
}

std::int64_t TopicCamera::stamp_ns(std::int64_t time_ns) const noexcept {
  return ear_->times.stamp_ns(time_ns);
}

void TopicCamera::tell_absent(Captured& captured) noexcept {
  captured.what = Capture::lost;
  captured.fault = absence_;
  captured.fault.append(" since ");
  append_milliseconds(captured.fault, clock_.now() - last_message_);
}

void TopicCamera::tell_silent(Captured& captured) noexcept {
  ++counters_.silences;
  // One that was killed counts as there for a while; its successor may offer something else.
  look_for_publisher();
  captured.what = Capture::silent;
  captured.fault.assign({"no picture on ", topic_, " for "});
  append_milliseconds(captured.fault, clock_.now() - last_message_);
}

void TopicCamera::give_back(const Captured& captured) noexcept {
  if (captured.buffer != no_buffer) ear_->out[captured.buffer] = {};
}

}  // namespace seqloop::dds
