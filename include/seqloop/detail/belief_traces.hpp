// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"

namespace seqloop {

/// The rows that hypotheses came through, frame by frame: a ring of the newest frames.
class BeliefTraces {
 public:
  /// Which hypothesis of a frame: a byte, so that what a trace is followed by stays in the nearest
  /// cache.
  using Index = std::uint8_t;

  /// The parent of a hypothesis that has come onto the map.
  static constexpr Index none = std::numeric_limits<Index>::max();

  /// @param depth frames that are kept. @param width hypotheses of a frame, at most `none`
  /// Allocates: from the arena only.
  BeliefTraces(Arena& arena, std::size_t depth, std::size_t width);

  /// A frame on the way to a row.
  struct Step {
    std::size_t row;
    double gain;     ///< ln of how much likelier the frame is there than somewhere new
    double novelty;  ///< of the frame, 0 .. 1
    double change;   ///< of the frame, as `Scene` has it
    /// Gain, with what is said besides, from which on the frame rather lies on the trace than
    /// before it.
    double asked = 0.0;
    bool elsewhere = false;  ///< whether the belief of its time was elsewhere
    /// As `in_step` has it; NaN: nothing is known.
    double in_step = std::numeric_limits<double>::quiet_NaN();
    bool shown = false;  ///< whether the frame by itself shows the row
    /// Its window's margin there; NaN: no line was found.
    double margin = std::numeric_limits<double>::quiet_NaN();
    double besides = 0.0;  ///< what that and `in_step` say for the trace besides the gain
    int moved = 0;         ///< to the side, the frame
  };

  /// Begins the next frame; `set` fills it in.
  void next(double novelty, double change) noexcept;

  /// A hypothesis of the newest frame.
  /// @param parent its index at the frame before, or none
  /// @param gain, in_step, shown as `Step` has them
  void set(std::size_t index, std::size_t row, Index parent, double gain, double in_step,
           bool shown) noexcept {
    set_parent(index, parent);
    steps_[newest_ * width_ + index] = {static_cast<std::uint32_t>(row), static_cast<float>(gain),
                                        static_cast<float>(in_step), shown};
  }

  /// A hypothesis of the newest frame came from another one. @param parent as above
  void set_parent(std::size_t index, Index parent) noexcept {
    parents_[newest_ * width_ + index] = parent;
  }

  /// The row that a hypothesis of the newest frame was at so many frames before; none if it was
  /// born later, or the row is not known any more. Work: as many.
  [[nodiscard]] std::optional<std::size_t> row_before(Index index,
                                                      std::size_t frames) const noexcept;

  /// The way that a row of the newest frame was come by, frame by frame back from there.
  /// @param out written, as many as there are at most. @return how many. Work: as many.
  std::size_t trace(std::size_t index, std::span<Step> out) const noexcept;

  /// A row went from the map: those behind it are counted one lower. A trace ends where it came
  /// from a place that has been forgotten. @param forgotten as `PlaceMap::Taken` has it
  void removed(std::size_t row, bool forgotten) noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept;

  void restart() noexcept { frames_ = 0; }

 private:
  struct Traced {
    std::uint32_t row;
    float gain;
    float in_step;
    bool shown;
  };

  [[nodiscard]] std::size_t before(std::size_t frame) const noexcept {
    return (frame == 0 ? novelties_.size() : frame) - 1;
  }

  std::size_t width_;
  std::size_t frames_ = 0;      // that are held
  std::size_t newest_ = 0;      // where it is
  std::span<Index> parents_;    // [depth, width]
  std::span<Traced> steps_;     // [depth, width]
  std::span<float> novelties_;  // [depth]
  std::span<float> changes_;    // [depth]
};

}  // namespace seqloop
