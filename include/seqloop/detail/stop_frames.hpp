// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "seqloop/detail/usual.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// Which frame of a stop a frame was matched with: those of one stop all show the same, and few of
/// them are places. Where drive and map both stood, their frames are taken to have gone by as they
/// did before, from the first of them that is known. Source: src/README.md, section 5.12.
class StopFrames {
 public:
  /// Nothing is known of where the robot was.
  void begin() noexcept { *this = {}; }

  /// A frame of the newest step, or of one before it.
  struct Frame {
    std::uint64_t number;
    bool stands;                          ///< whether it is one of several that show the same
    std::optional<std::uint64_t> leaves;  ///< the first that showed something else, if it has come
  };

  /// Says which frame of a stop it was at.
  /// @param place that it was matched with: stays, or becomes one of the same stop
  /// @return frames after that one
  /// Work: `PlaceMap::stop_at`. Allocates: never.
  [[nodiscard]] std::uint64_t stood(const PlaceMap& map, const Frame& frame,
                                    std::uint64_t& place) noexcept {
    const std::optional<std::size_t> row = map.order().row_of_number(place);
    const auto stop = row ? map.stop_at(*row, frame.stands) : std::nullopt;
    at_stop_ = stop.has_value();
    exactly_ = static_cast<double>(place);
    if (!stop) return 0;
    const std::size_t last = stop->last - 1;
    const auto first = static_cast<double>(map.order().number(stop->first));
    const auto end = static_cast<double>(map.order().number(last) + map.stood(last) + 1);
    // Who was at the place behind a stop was there too early, unless he had stood through it.
    const bool counts = known_ && known_->at_stop;
    const double behind = !counts && map.stood(last) == 0 ? end - 1.0 : end;
    constexpr auto near = static_cast<double>(PlaceMap::beside);
    if (known_ && known_->place + near >= first && known_->place < behind) {
      exactly_ = known_->place + pace_.mean() * static_cast<double>(frame.number - known_->frame);
    } else if (frame.leaves) {
      exactly_ = end - pace_.mean() * static_cast<double>(*frame.leaves - frame.number);
    } else if (exactly_ >= behind) {
      exactly_ = first;
    }
    exactly_ = std::clamp(exactly_, first, end - 1.0);
    constexpr double half = 0.5;
    const auto number = static_cast<std::uint64_t>(exactly_ + half);
    std::size_t at = last;
    while (map.order().number(at) > number) --at;
    place = map.order().number(at);
    return number - place;
  }

  /// The frame that was asked for last was there, for all that is known.
  void was_there(std::uint64_t frame) noexcept {
    if (known_ && frame == known_->frame + 1 && !known_->at_stop && !at_stop_) {
      constexpr double most = 4.0;
      pace_.take(std::clamp(exactly_ - known_->place, 0.0, most));
    }
    known_ = Known{frame, exactly_, at_stop_};
  }

 private:
  struct Known {
    std::uint64_t frame;
    double place;
    bool at_stop;
  };

  std::optional<Known> known_;  // the newest frame of which it is known
  double exactly_ = 0.0;        // where the frame was that was asked for last
  bool at_stop_ = false;        // likewise
  Usual pace_{1.0};             // the map's frames to one, where the robot moves
};

}  // namespace seqloop
