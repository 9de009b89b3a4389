// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop::live {

/// Memory for what is large, such as a map, each page of which is there already. A program that
/// touches them one by one waits for the system at each; here it is asked for all at once, by a
/// thread for each processor.
class TouchedMemory {
 public:
  /// @param bytes 1 or more. Throws SetupError: they are not to be had
  explicit TouchedMemory(std::uint64_t bytes);
  TouchedMemory(TouchedMemory&& other) noexcept;
  TouchedMemory& operator=(TouchedMemory&&) = delete;
  TouchedMemory(const TouchedMemory&) = delete;
  TouchedMemory& operator=(const TouchedMemory&) = delete;
  ~TouchedMemory();

  /// [bytes] zero at first, on a page's border.
  [[nodiscard]] std::span<std::byte> span() const noexcept { return span_; }

 private:
  std::span<std::byte> span_;
};

}  // namespace seqloop::live
