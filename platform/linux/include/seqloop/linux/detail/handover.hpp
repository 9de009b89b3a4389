// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace seqloop::live {

/// Three slots between one thread that writes and one that reads: the newest value wins. Each side
/// owns one slot; the third lies between them and changes hands by one atomic exchange, so that
/// neither side ever waits, copies or tears a value.
template <typename Value>
class Handover {
 public:
  /// The writer's slot, to be filled before `publish`.
  [[nodiscard]] Value& writing() noexcept { return slots_[write_]; }

  /// Hands the writer's slot over.
  /// @return the writer's new slot with its old content: a value that was never taken, one that the
  /// reader has finished with, or what was there from the start
  /// Work: one exchange. Allocates: never.
  Value& publish() noexcept {
    const std::uint32_t before = between_.exchange(write_ | fresh, std::memory_order_acq_rel);
    write_ = before & ~fresh;
    return slots_[write_];
  }

  /// Takes the newest value, and gives the one that was being read away.
  /// @return false when nothing has been published since; then `reading` stays what it is
  /// Work: one exchange. Allocates: never.
  [[nodiscard]] bool take() noexcept {
    if ((between_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    read_ = between_.exchange(read_, std::memory_order_acq_rel) & ~fresh;
    return true;
  }

  /// The value that was taken last; the reader's own until it takes the next one.
  [[nodiscard]] Value& reading() noexcept { return slots_[read_]; }
  [[nodiscard]] const Value& reading() const noexcept { return slots_[read_]; }

  /// All three, for when only one thread is left.
  [[nodiscard]] std::array<Value, 3>& slots() noexcept { return slots_; }

 private:
  static constexpr std::uint32_t fresh = 4;  // beside the slot's number: not taken yet

  std::array<Value, 3> slots_{};
  std::uint32_t write_ = 0;
  std::atomic<std::uint32_t> between_{1};
  std::uint32_t read_ = 2;
};

}  // namespace seqloop::live
