#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/arena.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// The newest columns of the difference matrix D, as a ring that is filled where somebody looks.
/// A difference is computed at most once. Columns are named by the frame that they belong to.
class DifferenceSlices {
 public:
  /// @param columns  differences kept, ds + 1
  /// @param history  query descriptors kept, >= columns
  /// @param capacity places of the map, descriptor size
  /// Allocates: from the arena only.
  DifferenceSlices(Arena& arena, std::size_t columns, std::size_t history,
                   const Capacity& capacity);

  /// Begins the next frame's column, forgetting the oldest, and returns where its descriptor goes.
  /// @return [padded_size(D)]: to be written up to D before anything else is asked
  /// Work: N, to mark every difference as not computed. Allocates: never.
  [[nodiscard]] std::span<float> push() noexcept;

  /// Frames pushed so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

  /// @param frame one of the newest `history` frames
  /// @return [padded_size(D)]
  [[nodiscard]] std::span<const float> query(std::uint64_t frame) const noexcept {
    return queries_.subspan(static_cast<std::size_t>(frame % history_) * stride_, stride_);
  }

  /// Makes sure that the differences of a frame to the rows [first, last) are there.
  /// @return how many had to be computed. Work: that many times D MACs. Allocates: never.
  std::size_t fill(const PlaceMap& map, std::uint64_t frame, std::size_t first,
                   std::size_t last) noexcept;

  /// @param frame one of the newest `columns` frames
  /// @return [capacity.places] distance 0 .. 2 where filled
  [[nodiscard]] std::span<const float> column(std::uint64_t frame) const noexcept {
    return differences_.subspan(static_cast<std::size_t>(frame % columns_) * places_, places_);
  }

 private:
  std::size_t columns_;
  std::size_t history_;
  std::size_t places_;
  std::size_t stride_;
  std::uint64_t frames_ = 0;
  std::span<float> queries_;          // [history, padded_size(D)]
  std::span<float> differences_;      // [columns, places]; below zero: not computed
  std::span<std::size_t> filled_to_;  // [columns]: rows before this one are all there
};

}  // namespace seqloop
