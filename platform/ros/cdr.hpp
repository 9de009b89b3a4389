// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ros/time.hpp"

namespace seqloop::ros {

/// Reads a message as ROS 2 serialises it: four bytes that say how, then CDR. Version 1 and the
/// plain version 2 in both byte orders. Whatever does not fit is a fault that stays: from then on
/// every value is zero or empty. Never reads outside the message. Allocates: never.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> message) noexcept {
    constexpr std::size_t header = 4;
    const unsigned kind =
        message.size() < header ? 0U : static_cast<unsigned>(message[0]) << 8U | message[1];
    if (message.size() < header) {
      fail("the message is shorter than its header");
    } else if (kind / 2 * 2 != cdr && kind / 2 * 2 != cdr2) {
      fail("the message is not serialised as plain CDR");
    } else {
      little_ = kind % 2 == 1;
      most_alignment_ = kind >= cdr2 ? 4 : 8;
      body_ = message.subspan(header);
    }
  }

  /// Any number of 1 to 8 bytes.
  template <class Number>
  [[nodiscard]] Number number() noexcept {
    align(sizeof(Number));
    const std::span<const std::uint8_t> bytes = take(sizeof(Number));
    if (bytes.empty()) return {};
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      value = value << 8U | bytes[little_ ? sizeof(Number) - 1 - i : i];
    using Bits = std::conditional_t<
        sizeof(Number) == 8, std::uint64_t,
        std::conditional_t<sizeof(Number) == 4, std::uint32_t,
                           std::conditional_t<sizeof(Number) == 2, std::uint16_t, std::uint8_t>>>;
    return std::bit_cast<Number>(static_cast<Bits>(value));
  }

  /// @return without the zero at its end; looks into the message
  [[nodiscard]] std::string_view text() noexcept {
    const std::span<const std::uint8_t> bytes = octets();
    std::string_view text(static_cast<const char*>(static_cast<const void*>(bytes.data())),
                          bytes.size());
    if (text.ends_with('\0')) text.remove_suffix(1);
    return text;
  }

  /// A `std_msgs/Header`; the name of its frame is passed over. @return nanoseconds since 1970
  [[nodiscard]] std::int64_t stamp() noexcept {
    constexpr std::int64_t second = 1'000'000'000;
    const std::int64_t seconds = number<std::int32_t>();
    const std::int64_t nanoseconds = number<std::uint32_t>();
    static_cast<void>(text());
    return seconds * second + nanoseconds;
  }

  /// A sequence of bytes; looks into the message.
  [[nodiscard]] std::span<const std::uint8_t> octets() noexcept {
    return take(number<std::uint32_t>());
  }

  /// Why the message cannot be read; empty where it could be so far.
  [[nodiscard]] std::string_view fault() const noexcept { return fault_; }

 private:
  static constexpr unsigned cdr = 0;
  static constexpr unsigned cdr2 = 6;

  void fail(std::string_view fault) noexcept {
    if (fault_.empty()) fault_ = fault;
    body_ = {};
    place_ = 0;
  }

  void align(std::size_t size) noexcept {
    const std::size_t to = size < most_alignment_ ? size : most_alignment_;
    static_cast<void>(take((to - place_ % to) % to));
  }

  [[nodiscard]] std::span<const std::uint8_t> take(std::size_t count) noexcept {
    if (count > body_.size() - place_) {
      fail("the message ends before its last value");
      return {};
    }
    place_ += count;
    return body_.subspan(place_ - count, count);
  }

  std::span<const std::uint8_t> body_;
  std::size_t place_ = 0;  // from the body's start, which is what values are aligned to
  std::size_t most_alignment_ = 8;
  bool little_ = true;
  std::string_view fault_;
};

/// Writes a message as ROS 2 does: CDR version 1, least byte first.
class CdrWriter {
 public:
  template <class Number>
  void number(Number value) {
    bytes_.resize(bytes_.size() +
                  (sizeof(Number) - (bytes_.size() - header) % sizeof(Number)) % sizeof(Number));
    static_assert(std::endian::native == std::endian::little || sizeof(Number) == 1);
    const std::size_t place = bytes_.size();
    bytes_.resize(place + sizeof(Number));
    std::memcpy(bytes_.data() + place, &value, sizeof(Number));
  }

  /// @param time_ns since 1970
  void time(std::int64_t time_ns) {
    const Time time = time_of(time_ns);
    number(time.sec);
    number(time.nanosec);
  }

  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }

  /// A sequence of bytes.
  void octets(std::span<const std::uint8_t> octets) {
    number(static_cast<std::uint32_t>(octets.size()));
    bytes_.insert(bytes_.end(), octets.begin(), octets.end());
  }

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const noexcept { return bytes_; }

 private:
  static constexpr std::size_t header = 4;
  std::vector<std::uint8_t> bytes_{0, 1, 0, 0};
};

}  // namespace seqloop::ros
