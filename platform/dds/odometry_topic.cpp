// SPDX-License-Identifier: MIT
#include "seqloop/dds/odometry_topic.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "dds/subscription.hpp"

namespace seqloop::dds {

OdometryTopic::OdometryTopic(const Participant& participant, std::string topic, std::size_t most)
    : participant_(participant), topic_(std::move(topic)), most_(most) {
  check_topic(topic_, "odometry");
  try {
    thread_ = std::thread(&OdometryTopic::listen, this);
  } catch (const std::system_error& error) {
    throw SetupError({"odometry", std::string("no thread: ") + error.what()});
  }
}

OdometryTopic::~OdometryTopic() {
  ending_ = true;
  thread_.join();
}

std::vector<ros::OdometryPose> OdometryTopic::poses() const {
  const std::scoped_lock lock(mutex_);
  return poses_;
}

void OdometryTopic::listen() noexcept {
  constexpr Nanoseconds time_step = std::chrono::milliseconds(50);
  constexpr std::int32_t depth = 1000;  // robots say it a hundred times a second, or more
  const TopicType& type = topic_type("nav_msgs/msg/Odometry");
  std::unique_ptr<Subscription> subscription;
  bool reliable = false;
  while (!ending_) {
    try {
      if (!subscription || subscription->publishers() == 0) {
        const std::optional<Offer> offer = participant_.offer(topic_);
        if (offer && offer->type == type.name && (!subscription || reliable != offer->reliable)) {
          subscription.reset();
          subscription =
              std::make_unique<Subscription>(participant_, topic_, type, offer->reliable, depth);
          reliable = offer->reliable;
        }
      }
      if (!subscription) {
        std::this_thread::sleep_for(time_step);
        continue;
      }
      subscription->wait(time_step);
      for (Message message = subscription->take(); !message.bytes().empty();
           message = subscription->take()) {
        if (const auto pose = ros::read_odometry(message.bytes())) keep(*pose);
      }
    } catch (const std::exception&) {  // memory or DDS is short: try again later
      std::this_thread::sleep_for(time_step);
    }
  }
}

/// Stamps that go back are kept: whether one of them is odd, or the clock was set back, is known
/// only later.
void OdometryTopic::keep(const ros::OdometryPose& pose) {
  constexpr std::int64_t longest_interval_ns = 1'000'000'000;
  const std::scoped_lock lock(mutex_);
  if (!poses_.empty()) {
    const std::int64_t since_last = pose.stamp_ns - poses_.back().stamp_ns;
    if (since_last >= 0 && since_last < least_interval_ns_) return;
  }
  if (poses_.size() >= most_) {
    least_interval_ns_ = std::min(2 * least_interval_ns_, longest_interval_ns);
    for (std::size_t i = 0; 2 * i < poses_.size(); ++i) poses_[i] = poses_[2 * i];
    poses_.resize((poses_.size() + 1) / 2);
  }
  poses_.push_back(pose);
}

}  // namespace seqloop::dds
