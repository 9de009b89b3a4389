// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace seqloop {

/// One buffer that a component takes: what it is and how large, padding included. Counted in 64
/// bits on 32-bit systems too, where a plan may be of more than they have.
struct BufferSize {
  std::string_view name;
  std::uint64_t bytes;
};

/// The sum of all buffers.
[[nodiscard]] inline std::uint64_t total_bytes(const std::vector<BufferSize>& buffers) {
  std::uint64_t sum = 0;
  for (const BufferSize& buffer : buffers) sum += buffer.bytes;
  return sum;
}

/// Hands out the one piece of memory that a component lives in, front to back, and never takes any
/// back. The same calls run in two ways, so that a plan cannot drift from what is really used:
/// measuring (each buffer is written down, none exists) and taking (each buffer is zeroed, which
/// also makes its pages resident before the first frame; unless the caller knows that it is zero).
class Arena {
 public:
  /// Buffers start on a cache line, so that no two share one and SIMD loads are aligned.
  static constexpr std::size_t alignment = 64;

  /// Measures: `take` appends to `plan` and returns empty spans.
  explicit Arena(std::vector<BufferSize>& plan) noexcept : plan_(&plan) {}

  /// Hands out `memory`, which must be aligned to `alignment` and large enough.
  /// @param zeroed whether it is zero: then nothing is written to it
  explicit Arena(std::span<std::byte> memory, bool zeroed = false) noexcept
      : rest_(memory), zeroed_(zeroed) {}

  [[nodiscard]] bool measuring() const noexcept { return plan_ != nullptr; }

  /// @param name what the buffer holds, for the plan; must outlive it
  /// @return [count] zeroed values, or nothing while measuring
  /// Errors: std::bad_alloc when the memory does not suffice.
  template <class T>
  [[nodiscard]] std::span<T> take(std::string_view name, std::uint64_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "an arena destroys nothing");
    const std::uint64_t bytes = (count * sizeof(T) + alignment - 1) / alignment * alignment;
    if (measuring()) {
      plan_->push_back({name, bytes});
      return {};
    }
    if (bytes > rest_.size()) throw std::bad_alloc();
    // By way of void: what lies there is aligned, which the compiler cannot know.
    T* first = static_cast<T*>(static_cast<void*>(rest_.data()));
    const auto taken = static_cast<std::size_t>(count);
    if (!zeroed_ || !std::is_trivially_default_constructible_v<T>) {
      std::uninitialized_value_construct_n(first, taken);
    }
    rest_ = rest_.subspan(static_cast<std::size_t>(bytes));
    return {first, taken};
  }

 private:
  std::vector<BufferSize>* plan_ = nullptr;
  std::span<std::byte> rest_;
  bool zeroed_ = false;
};

/// Memory for an arena: the caller's when it is given, own otherwise. Taken once, freed at the end.
class ArenaMemory {
 public:
  /// @param bytes  how much is needed
  /// @param memory the caller's piece; empty: take it from the heap
  /// Errors: SetupError when the caller's piece is too small or not aligned to Arena::alignment,
  /// or when the heap has no such piece.
  ArenaMemory(std::uint64_t bytes, std::span<std::byte> memory);

  /// No memory: what a component that is only measured lives in.
  ArenaMemory() = default;

  [[nodiscard]] std::span<std::byte> span() const noexcept { return span_; }

 private:
  struct Free {
    void operator()(std::byte* memory) const noexcept {
      ::operator delete (memory, std::align_val_t{Arena::alignment});
    }
  };
  std::unique_ptr<std::byte, Free> own_;
  std::span<std::byte> span_;
};

}  // namespace seqloop
