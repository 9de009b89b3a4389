// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace seqloop::program {

/// @param time_s of the drive's own clock
/// @return what the clock of its pictures' headers said then, in nanoseconds since 1970; 0: not
///   known any more. Of a topic, once a frame has come; then any thread may ask
using StampAt = std::function<std::int64_t(double time_s)>;

/// When each frame of a drive was taken, by its number. 16 bytes a frame.
class FrameTimes {
 public:
  /// @param frame higher than all before   @param time_s of the drive's own clock
  void add(std::uint64_t frame, double time_s) { times_.emplace_back(frame, time_s); }

  /// Of the newest frame; 0 before the first.
  [[nodiscard]] double newest_s() const noexcept {
    return times_.empty() ? 0.0 : times_.back().second;
  }

  /// All of them: frame, time.
  [[nodiscard]] const std::vector<std::pair<std::uint64_t, double>>& all() const noexcept {
    return times_;
  }

  /// @return nothing for a frame that never came
  [[nodiscard]] std::optional<double> at(std::uint64_t frame) const noexcept {
    const auto found = std::ranges::lower_bound(times_, frame, {}, &Entry::first);
    if (found == times_.end() || found->first != frame) return std::nullopt;
    return found->second;
  }

 private:
  using Entry = std::pair<std::uint64_t, double>;
  std::vector<Entry> times_;
};

}  // namespace seqloop::program
