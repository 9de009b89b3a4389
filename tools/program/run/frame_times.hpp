// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <vector>

namespace seqloop::program {

/// @param time_s of the drive's own clock
/// @return what the clock of its pictures' headers said then, in nanoseconds since 1970; 0: not
///   known any more. Of a topic, once a frame has come; then any thread may ask
using StampAt = std::function<std::int64_t(double time_s)>;

/// When each frame of a drive was taken, by its number and by that of its place. 40 bytes a frame.
class FrameTimes {
 public:
  struct Entry {
    std::uint64_t frame;
    double time_s;                       ///< of the drive's own clock
    std::optional<std::uint64_t> place;  ///< the number that it has as a place, or would have
  };

  /// @param entry its numbers are higher than all before; all have a place, or none has
  void add(const Entry& entry) { times_.push_back(entry); }

  /// Of the newest frame; 0 before the first.
  [[nodiscard]] double newest_s() const noexcept {
    return times_.empty() ? 0.0 : times_.back().time_s;
  }

  [[nodiscard]] const std::vector<Entry>& all() const noexcept { return times_; }

  /// @return nothing for a frame that never came
  [[nodiscard]] std::optional<double> at(std::uint64_t frame) const noexcept {
    const auto found = std::ranges::lower_bound(times_, frame, {}, &Entry::frame);
    if (found == times_.end() || found->frame != frame) return std::nullopt;
    return found->time_s;
  }

  /// The frame that came nearest to a place. @return null where the place is of no frame of the
  /// drive
  [[nodiscard]] const Entry* nearest(std::uint64_t place) const noexcept {
    const auto next = std::ranges::lower_bound(times_, std::optional(place), {}, &Entry::place);
    if (next == times_.end()) return nullptr;
    if (next->place == place) return &*next;
    if (next == times_.begin()) return nullptr;
    const auto before = std::prev(next);
    return place - *before->place <= *next->place - place ? &*before : &*next;
  }

 private:
  std::vector<Entry> times_;
};

}  // namespace seqloop::program
