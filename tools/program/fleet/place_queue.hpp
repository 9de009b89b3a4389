// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace seqloop::program {

/// Places of other robots on their way from the thread that hears them to the loop, in order.
/// Neither side waits.
class PlaceQueue {
 public:
  struct Place {
    std::uint32_t session = 0;
    std::uint64_t frame = 0;
    std::span<const std::byte> bytes{};
    /// Nothing new, and no bytes: it is the same place as this one.
    struct Visited {
      std::uint32_t session = 0;
      std::uint64_t frame = 0;
    };
    std::optional<Visited> visited = {};
  };

  PlaceQueue(std::size_t places, std::size_t place_bytes)
      : size_(place_bytes), bytes_(places * place_bytes), places_(places) {}

  [[nodiscard]] bool full() const noexcept {
    return in_.load(std::memory_order_relaxed) - out_.load(std::memory_order_acquire) ==
           places_.size();
  }

  /// There must be room. @param place its bytes, at most place_bytes, are copied
  void push(const Place& place) noexcept {
    const std::size_t in = in_.load(std::memory_order_relaxed);
    const std::size_t at = in % places_.size();
    const auto kept = std::span(bytes_).subspan(at * size_, place.bytes.size());
    std::ranges::copy(place.bytes, kept.begin());
    places_[at] = {place.session, place.frame, kept, place.visited};
    in_.store(in + 1, std::memory_order_release);
  }

  /// @return the oldest, valid until `pop`; null when there is none. Allocates: never.
  [[nodiscard]] const Place* front() const noexcept {
    const std::size_t out = out_.load(std::memory_order_relaxed);
    if (out == in_.load(std::memory_order_acquire)) return nullptr;
    return &places_[out % places_.size()];
  }

  /// Lets go of the oldest; there must be one.
  void pop() noexcept { out_.fetch_add(1, std::memory_order_release); }

 private:
  std::size_t size_;
  std::vector<std::byte> bytes_;
  std::vector<Place> places_;
  std::atomic<std::size_t> in_{0};   // the hearing thread's
  std::atomic<std::size_t> out_{0};  // the loop's
};

}  // namespace seqloop::program
