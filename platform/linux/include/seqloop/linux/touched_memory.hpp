// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

namespace seqloop::live {

/// Memory for what is large, such as a map, each page of which is there once it is waited for. A
/// program that touches them one by one waits for the system at each; here it is asked for in
/// large pieces, by a thread for each processor, while a map is read from a disk. Pages are large
/// ones where the system gives them to who asks.
class TouchedMemory {
 public:
  /// Begins to ask for the pages. @param bytes 1 or more. Throws SetupError: they are not to be had
  explicit TouchedMemory(std::uint64_t bytes);
  TouchedMemory(TouchedMemory&& other) noexcept;
  TouchedMemory& operator=(TouchedMemory&&) = delete;
  TouchedMemory(const TouchedMemory&) = delete;
  TouchedMemory& operator=(const TouchedMemory&) = delete;
  ~TouchedMemory();

  /// [bytes] zero at first, on a page's border. May be used at once; a page that is not there yet
  /// then comes when it is touched.
  [[nodiscard]] std::span<std::byte> span() const noexcept { return span_; }

  /// Returns when each page is there.
  void wait() noexcept { touching_.clear(); }

 private:
  std::span<std::byte> span_;
  std::vector<std::jthread> touching_;
};

}  // namespace seqloop::live
