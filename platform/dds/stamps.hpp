// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace seqloop::dds {

/// What a clock that is set back now and then said at each time of a drive. One thread adds, any
/// other may ask meanwhile; nobody waits. Allocates: never.
class Stamps {
 public:
  static constexpr std::size_t remembered = 64;  ///< times that the clock was set

  /// @param from_ns since second 0, from which on it holds; never before the last
  /// @param start_ns what the clock said at second 0, or would have
  void add(std::int64_t from_ns, std::int64_t start_ns) noexcept {
    const std::uint64_t number = added_.load();
    Entry& entry = entries_[number % remembered];
    begun_.store(number + 1);
    entry.from_ns.store(from_ns);
    entry.start_ns.store(start_ns);
    added_.store(number + 1);
  }

  /// @param time_ns since second 0
  /// @return what the clock said; 0 where that is longer ago than is remembered
  [[nodiscard]] std::int64_t at(std::int64_t time_ns) const noexcept {
    for (std::uint64_t end = added_.load(); end > 0; --end) {
      const Entry& entry = entries_[(end - 1) % remembered];
      const std::int64_t from_ns = entry.from_ns.load();
      const std::int64_t start_ns = entry.start_ns.load();
      // Another has its place, or takes it just now.
      if (begun_.load() >= end + remembered) return 0;
      if (from_ns <= time_ns) return start_ns + time_ns;
    }
    return 0;
  }

 private:
  struct Entry {
    std::atomic<std::int64_t> from_ns{0};
    std::atomic<std::int64_t> start_ns{0};
  };

  std::array<Entry, remembered> entries_{};
  std::atomic<std::uint64_t> begun_{0};
  std::atomic<std::uint64_t> added_{0};
};

}  // namespace seqloop::dds
