#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/arena.hpp"
#include "seqloop/column_ring.hpp"
#include "seqloop/contrast.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// The newest columns of the difference matrix D, ds + 1 of them, filled where somebody looks and
/// enhanced where that is asked for. A difference is computed at most once. Columns are named by
/// the frame that they belong to.
class DifferenceSlices {
 public:
  /// @param history  query descriptors kept, above ds
  /// @param capacity places of the map, descriptor size
  /// Allocates: from the arena only.
  DifferenceSlices(Arena& arena, const MatcherConfig& config, std::size_t history,
                   const Capacity& capacity);

  /// Begins the next frame's column, forgetting the oldest, and returns where its descriptor goes.
  /// @return [padded_size(D)]: to be written up to D before anything else is asked
  /// Work: N, to mark every difference as not computed. Allocates: never.
  [[nodiscard]] std::span<float> push() noexcept;

  /// Takes another frame that is the same as the newest one; at least one must have been pushed.
  /// Work: N + D copies. Allocates: never.
  void repeat() noexcept;

  /// Frames pushed so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

  /// @param frame one of the newest `history` frames
  /// @return [padded_size(D)]
  [[nodiscard]] std::span<const float> query(std::uint64_t frame) const noexcept {
    return queries_.subspan(static_cast<std::size_t>(frame % history_) * stride_, stride_);
  }

  /// The difference of two of the newest `history` frames. Work: D MACs.
  [[nodiscard]] float between(std::uint64_t a, std::uint64_t b) const noexcept;

  /// Makes sure that the differences of a frame to the rows [first, last) are there; enhanced ones
  /// need those of rwindow / 2 rows on either side too.
  /// @return how many had to be computed. Work: that many times D MACs. Allocates: never.
  std::size_t fill(const PlaceMap& map, std::uint64_t frame, std::size_t first,
                   std::size_t last) noexcept;

  /// @param frame one of the newest ds + 1 frames
  /// @return [capacity.places] where filled: distance (0 .. 2 between unit vectors), or what
  ///   `Contrast` makes of it
  [[nodiscard]] std::span<const float> column(std::uint64_t frame) const noexcept {
    return enhance_ ? enhanced_.column(frame) : differences_.column(frame);
  }

 private:
  [[nodiscard]] std::span<float> descriptor(std::uint64_t frame) noexcept {
    return queries_.subspan(static_cast<std::size_t>(frame % history_) * stride_, stride_);
  }

  Difference kind_;
  bool enhance_;
  Contrast contrast_;
  std::size_t history_;
  std::size_t stride_;
  std::size_t descriptor_size_;
  std::uint64_t frames_ = 0;
  std::span<float> queries_;  // [history, padded_size(D)]
  ColumnRing differences_;
  ColumnRing enhanced_;  // empty unless asked for
};

}  // namespace seqloop
