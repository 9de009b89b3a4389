// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "seqloop/detail/arena.hpp"

namespace seqloop {

/// The rows that hypotheses came through, frame by frame: a ring of the newest frames.
class BeliefTraces {
 public:
  /// The parent of a hypothesis that has come onto the map.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// @param depth frames that are kept. @param width hypotheses of a frame, at most
  /// Allocates: from the arena only.
  BeliefTraces(Arena& arena, std::size_t depth, std::size_t width);

  /// A frame on the way to a row.
  struct Step {
    std::size_t row;
    double gain;     ///< ln of how much likelier the frame is there than somewhere new
    double novelty;  ///< of the frame, 0 .. 1
  };

  /// Begins the next frame; `set` fills it in.
  void next(double novelty) noexcept;

  /// A hypothesis of the newest frame.
  /// @param parent its index at the frame before, or none
  void set(std::size_t index, std::size_t row, std::uint32_t parent, double gain) noexcept;

  /// The way that a row of the newest frame was come by, frame by frame back from there.
  /// @param out written, as many as there are at most. @return how many. Work: as many.
  std::size_t trace(std::size_t index, std::span<Step> out) const noexcept;

  /// A row went from the map: those behind it are counted one lower.
  void removed(std::size_t row) noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept;

  void restart() noexcept { frames_ = 0; }

 private:
  struct Traced {
    std::uint32_t row;
    std::uint32_t parent;
    float gain;
  };
  [[nodiscard]] std::size_t slot(std::uint64_t back) const noexcept {
    return static_cast<std::size_t>((frames_ - 1 - back) % novelties_.size());
  }

  std::size_t width_;
  std::uint64_t frames_ = 0;
  std::span<Traced> steps_;     // [depth, width]
  std::span<float> novelties_;  // [depth]
};

}  // namespace seqloop
