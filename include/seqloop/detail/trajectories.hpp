// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"

namespace seqloop {

/// The velocities m / ds that give different lines: every integer m in [first, last].
/// Source: src/README.md, section 4.2.
struct VelocityRange {
  std::int64_t first;
  std::int64_t last;

  [[nodiscard]] std::size_t count() const noexcept {
    return last < first ? 0 : static_cast<std::size_t>(last - first + 1);
  }
};

/// @param ds   sequence length; 0: single frames, whose one line is a point
/// @param vmin, vmax 0 <= vmin <= vmax, rows a frame
[[nodiscard]] VelocityRange velocity_range(std::size_t ds, double vmin, double vmax) noexcept;

/// Rows that a line of velocity m / ds lies above its centre row, at column i of the window: round
/// half up of m * (i - ds/2) / ds, in integers. Zero at the centre column. Source: src/README.md,
/// section 3.3.
[[nodiscard]] std::int64_t trajectory_offset(std::int64_t m, std::size_t i,
                                             std::size_t ds) noexcept;

/// All lines through a cell, as a table of row offsets. Source: Algorithm 2,
/// as src/README.md, section 4, reads it.
class Trajectories {
 public:
  /// Work: M * (ds + 1). Allocates: from the arena only.
  Trajectories(Arena& arena, std::size_t ds, double vmin, double vmax);

  [[nodiscard]] std::size_t window() const noexcept { return ds_ + 1; }        ///< columns, ds + 1
  [[nodiscard]] std::size_t centre() const noexcept { return ds_ / 2; }        ///< h
  [[nodiscard]] std::size_t count() const noexcept { return range_.count(); }  ///< M
  /// Rows a frame; NaN for single frames.
  [[nodiscard]] double velocity(std::size_t line) const noexcept;

  /// @param line index of the velocity, slowest first, 0 .. count()
  /// @return [window()] rows above the centre row, column by column; never falls along the window
  [[nodiscard]] std::span<const std::int32_t> offsets(std::size_t line) const noexcept {
    return offsets_.subspan(line * window(), window());
  }

  /// Lowest and highest offset of any line at column i. Offsets are monotone in m: left of the
  /// centre the fastest line is the lowest, right of it the slowest.
  [[nodiscard]] std::int32_t lowest(std::size_t i) const noexcept {
    return offsets(i < centre() ? count() - 1 : 0)[i];
  }
  [[nodiscard]] std::int32_t highest(std::size_t i) const noexcept {
    return offsets(i < centre() ? 0 : count() - 1)[i];
  }

 private:
  std::size_t ds_;
  VelocityRange range_;
  std::span<std::int32_t> offsets_;  // [M, ds + 1]
};

}  // namespace seqloop
