// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "seqloop/dds/network.hpp"

namespace seqloop::dds {

/// What a publisher offers on a topic.
struct Offer {
  std::string type;       ///< `sensor_msgs/msg/Image`; what is no type of ROS 2 as it is
  bool reliable = false;  ///< sends again what was lost
  bool operator==(const Offer&) const = default;
};

/// This program among those that ROS 2's network has. From its making on, UDP ports are open
/// (7400 and up), and others see it. There is one at a time in a process.
class Participant {
 public:
  /// Throws SetupError: what Cyclone DDS says of the network or its configuration.
  explicit Participant(const Network& network);
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;
  Participant(Participant&&) = delete;
  Participant& operator=(Participant&&) = delete;
  ~Participant();

  /// Of DDS.
  [[nodiscard]] std::int32_t handle() const noexcept { return handle_; }

  /// What the publisher offers that came last, of those that are there. Work: publishers of all
  /// topics. Allocates. Any thread may call it.
  /// @param topic as ROS 2 names it
  [[nodiscard]] std::optional<Offer> offer(const std::string& topic) const;

  /// Messages of a topic that were dropped because they are none of its type, or too large. Any
  /// thread may ask.
  [[nodiscard]] std::uint64_t refused(const std::string& topic) const;

 private:
  class Log;
  std::unique_ptr<Log> log_;
  std::int32_t domain_ = 0;
  std::int32_t handle_ = 0;
};

}  // namespace seqloop::dds
