// SPDX-License-Identifier: MIT
#include "seqloop/dds/publisher.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "dds/entity.hpp"
#include "dds/idl/ros2.h"
#include "dds/idl/seqloop_msgs.h"
#include "ros/time.hpp"

namespace seqloop::dds {
namespace {

builtin_interfaces_msg_dds__Time_ time_of(std::int64_t time_ns) {
  const ros::Time time = ros::time_of(time_ns);
  return {time.sec, time.nanosec};
}

std_msgs_msg_dds__Header_ header(std::int64_t stamp_ns, const std::string& frame) {
  return {time_of(stamp_ns), text(frame)};
}

/// A writer of one topic.
class Writer {
 public:
  Writer(const Participant& participant, const std::string& topic, std::string_view type,
         std::int32_t depth)
      : topic_(dds_create_topic(participant.handle(), topic_type(type).descriptor,
                                wire_name(topic).c_str(), nullptr, nullptr),
               topic),
        writer_(dds_create_writer(participant.handle(), topic_.handle(),
                                  make_qos(topic_type(type), true, depth).get(), nullptr),
                topic) {}

  /// @param message of the topic's type
  [[nodiscard]] bool write(const void* message) noexcept {
    return dds_write(writer_.handle(), message) == DDS_RETCODE_OK;
  }

  [[nodiscard]] bool is_heard() const noexcept {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer_.handle(), &status);
    return status.current_count > 0;
  }

  void flush(Nanoseconds at_most) noexcept { dds_wait_for_acks(writer_.handle(), at_most.count()); }

 private:
  Entity topic_;
  Entity writer_;
};

// Many answers may be due at once, at the end above all.
constexpr std::int32_t most_answers = 1000;
constexpr std::int32_t usual_depth = 10;  // as ROS 2 has it

}  // namespace

class Publisher::Impl {
 public:
  explicit Impl(const Participant& participant)
      : closures(participant, "/seqloop/loop_closures", "seqloop_msgs/msg/LoopClosure",
                 most_answers),
        status(participant, "/seqloop/status", "seqloop_msgs/msg/Status", usual_depth),
        diagnostics(participant, "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray",
                    usual_depth),
        pairs(participant, "/seqloop/matched_pair/compressed", "sensor_msgs/msg/CompressedImage",
              2) {}

  Writer closures;
  Writer status;
  Writer diagnostics;
  Writer pairs;
};

Publisher::Publisher(const Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

Publisher::~Publisher() = default;

bool Publisher::publish(const ros::LoopClosure& closure) {
  const std::string nothing;
  const std::string session(closure.session);
  const std::string robot(closure.robot);
  seqloop_msgs_msg_dds__LoopClosure_ message{};
  message.header = header(closure.stamp_ns, nothing);
  message.match_stamp = time_of(closure.match_stamp_ns);
  message.frame = closure.frame;
  message.match = closure.match;
  message.session = text(session);
  message.robot = text(robot);
  message.probability = closure.probability;
  message.uniqueness = closure.uniqueness;
  message.score = closure.score;
  message.velocity = closure.velocity;
  return impl_->closures.write(&message);
}

bool Publisher::publish(const ros::Status& status) {
  const std::string nothing;
  seqloop_msgs_msg_dds__Status_ message{};
  message.header = header(status.stamp_ns, nothing);
  message.state = text(status.state);
  message.frames = status.frames;
  message.matches = status.matches;
  message.places = status.places;
  message.place_known = status.place.has_value();
  message.place = status.place.value_or(0);
  message.probability = status.probability;
  message.errors = status.errors;
  message.dropped = status.dropped;
  message.lost = status.lost;
  message.misses = status.misses;
  message.unpublished = status.unpublished;
  return impl_->status.write(&message);
}

bool Publisher::publish(std::int64_t stamp_ns, std::span<const ros::Diagnosis> diagnoses) {
  using KeyValue = diagnostic_msgs_msg_dds__KeyValue_;
  const std::string nothing;
  std::vector<std::vector<KeyValue>> values;
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> parts;
  for (const ros::Diagnosis& diagnosis : diagnoses) {
    std::vector<KeyValue>& own = values.emplace_back();
    for (const auto& [key, value] : diagnosis.values) own.push_back({text(key), text(value)});
    diagnostic_msgs_msg_dds__DiagnosticStatus_& part = parts.emplace_back();
    part.level = static_cast<std::uint8_t>(diagnosis.level);
    part.name = text(diagnosis.name);
    part.message = text(diagnosis.message);
    part.hardware_id = text(nothing);
    part.values._buffer = own.data();
    part.values._length = part.values._maximum = static_cast<std::uint32_t>(own.size());
  }
  diagnostic_msgs_msg_dds__DiagnosticArray_ message{};
  message.header = header(stamp_ns, nothing);
  message.status._buffer = parts.data();
  message.status._length = message.status._maximum = static_cast<std::uint32_t>(parts.size());
  return impl_->diagnostics.write(&message);
}

bool Publisher::publish_pair(std::int64_t stamp_ns, std::span<const std::uint8_t> jpeg) {
  const std::string nothing;
  const std::string format = "jpeg";
  sensor_msgs_msg_dds__CompressedImage_ message{};
  message.header = header(stamp_ns, nothing);
  message.format = text(format);
  message.data._buffer = const_cast<std::uint8_t*>(jpeg.data());
  message.data._length = message.data._maximum = static_cast<std::uint32_t>(jpeg.size());
  return impl_->pairs.write(&message);
}

bool Publisher::pair_is_wanted() const noexcept { return impl_->pairs.is_heard(); }

void Publisher::flush(Nanoseconds at_most) noexcept {
  impl_->closures.flush(at_most);
  impl_->status.flush(at_most);
}

}  // namespace seqloop::dds
