// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "seqloop/detail/frame_steps.hpp"
#include "seqloop/detail/usual.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// A frame of a map's drive: a place, or so many frames after it, at which the robot stood there.
struct StopFrame {
  std::uint64_t place;
  std::uint64_t stood;
};

/// Which frame of a stop a frame was matched with. Those of one stop all show the same, and few of
/// them are places. Where drive and map both stood for long, the frames of the two stops are taken
/// to go by together. Source: src/README.md, section 5.12.
class StopFrames {
 public:
  /// Nothing is known of where the robot was.
  void begin() noexcept { *this = {}; }

  /// @param stop  of the drive, that the frame is part of or beside; none: it is neither
  /// @param place that the frame was matched with
  /// @return that place or, where the map has a stop, a frame of that, or the place beside it
  /// Work: `PlaceMap::stop_at`. Allocates: never.
  [[nodiscard]] StopFrame at(const PlaceMap& map, const std::optional<FrameSteps::Stop>& stop,
                             std::uint64_t frame, std::uint64_t place) const noexcept {
    const PlaceOrder& order = map.order();
    const auto row = stop ? order.row_of_number(place) : std::nullopt;
    const auto rows = row ? map.stop_at(*row) : std::nullopt;
    if (!rows) return {place, 0};
    std::size_t there = rows->last - 1;
    // On its way to the stop the robot is at its first frame, or before it.
    if (frame < stop->came) return {order.number(std::min(*row, rows->first)), 0};
    const auto first = static_cast<double>(order.number(rows->first));
    const auto end = static_cast<double>(order.number(there) + map.stood(there));
    const auto now = static_cast<double>(frame);
    const bool counts_back = stop->left && !stop->seen_to_come;
    const double at =
        counts_back
            ? end + 1.0 - pace_.mean() * (static_cast<double>(*stop->left) - now)
            : comes(*stop, first, end) + pace_.mean() * (now - static_cast<double>(stop->came));
    // On its way from there it may be beyond it, unless it hardly moves and the map's stop is
    // nearly over.
    constexpr double nearly = 20.0;
    const bool has_left = stop->left && frame >= *stop->left && *row > there;
    if (has_left && (at > end || at + nearly < end)) return {place, 0};
    constexpr double half = 0.5;
    const auto number = static_cast<std::uint64_t>(std::clamp(at, first, end) + half);
    while (there > rows->first && order.number(there) > number) --there;
    // Frames that never came may lie between two places at which it stood.
    return {order.number(there), std::min(number - order.number(there), map.stood(there))};
  }

  /// The robot was at a place with a frame, beside no stop, for all that is known.
  void was_at(std::uint64_t frame, std::uint64_t place) noexcept {
    if (known_ && frame <= known_->frame) return;
    if (known_ && frame == known_->frame + 1 && place >= known_->place) {
      constexpr std::uint64_t most = 4;
      pace_.take(static_cast<double>(std::min(place - known_->place, most)));
    }
    known_ = Known{frame, place};
  }

 private:
  struct Known {
    std::uint64_t frame;
    std::uint64_t place;
  };

  /// Where the robot was when it came to a stop: as it went on to there, or at the map's.
  [[nodiscard]] double comes(const FrameSteps::Stop& stop, double first,
                             double end) const noexcept {
    constexpr std::uint64_t lately = 10;
    if (!known_ || known_->frame >= stop.came || known_->frame + lately < stop.came) return first;
    const double came = static_cast<double>(known_->place) +
                        pace_.mean() * static_cast<double>(stop.came - known_->frame);
    return came + static_cast<double>(PlaceMap::beside) >= first && came < end ? came : first;
  }

  std::optional<Known> known_;  // the newest
  Usual pace_{1.0};             // the map's frames to one, where the robot moves
};

}  // namespace seqloop
