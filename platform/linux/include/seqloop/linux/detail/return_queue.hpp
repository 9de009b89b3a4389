// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace seqloop::live {

/// What one thread has finished with, on its way back to another, in order. Neither side waits.
template <typename Value, std::size_t capacity>
class ReturnQueue {
 public:
  /// @return false when it is full: then nothing has changed. Allocates: never.
  [[nodiscard]] bool push(const Value& value) noexcept {
    const std::size_t in = in_.load(std::memory_order_relaxed);
    if (in - out_.load(std::memory_order_acquire) == capacity) return false;
    values_[in % capacity] = value;
    in_.store(in + 1, std::memory_order_release);
    return true;
  }

  /// @return the oldest value, valid until `pop`; null when there is none. Allocates: never.
  [[nodiscard]] const Value* front() const noexcept {
    const std::size_t out = out_.load(std::memory_order_relaxed);
    if (out == in_.load(std::memory_order_acquire)) return nullptr;
    return &values_[out % capacity];
  }

  /// Lets go of the oldest value; there must be one.
  void pop() noexcept { out_.fetch_add(1, std::memory_order_release); }

 private:
  std::array<Value, capacity> values_{};
  std::atomic<std::size_t> in_{0};   // the giver's
  std::atomic<std::size_t> out_{0};  // the taker's
};

}  // namespace seqloop::live
