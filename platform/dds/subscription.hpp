// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "dds/entity.hpp"
#include "dds/topic_type.hpp"
#include "seqloop/clock.hpp"
#include "seqloop/dds/participant.hpp"

struct ddsi_serdata;

namespace seqloop::dds {

/// A message as it came, in the memory where DDS has put its packets together.
class Message {
 public:
  Message() noexcept = default;
  /// @param data that this is one reference to
  explicit Message(ddsi_serdata* data) noexcept;
  Message(const Message&) = delete;
  Message& operator=(const Message&) = delete;
  Message(Message&& other) noexcept;
  Message& operator=(Message&& other) noexcept;
  ~Message();

  /// Four bytes that say how it is serialised, and the rest; empty where there is none.
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return bytes_; }

 private:
  ddsi_serdata* data_ = nullptr;
  std::span<const std::uint8_t> bytes_;
};

/// A reader of one topic.
class Subscription {
 public:
  /// @param participant lives longer   @param depth newest messages that are kept until taken
  /// Throws SetupError.
  Subscription(const Participant& participant, const std::string& topic, const TopicType& type,
               bool reliable, std::int32_t depth);
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;
  Subscription(Subscription&&) = delete;
  Subscription& operator=(Subscription&&) = delete;
  ~Subscription() = default;

  /// Returns when there is something to take, or after the time.
  void wait(Nanoseconds at_most) noexcept;

  /// @return the oldest message that has not been taken; empty where there is none
  /// Copies nothing. Allocates: never.
  [[nodiscard]] Message take() noexcept;

  /// Publishers that it hears.
  [[nodiscard]] std::uint32_t publishers() const noexcept;

 private:
  Entity topic_;
  Entity reader_;
  Entity waits_;
};

}  // namespace seqloop::dds
