// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/column_ring.hpp"
#include "seqloop/detail/contrast.hpp"
#include "seqloop/detail/query_history.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// The newest columns of the difference matrix D, ds + 1 of them and those that are taken ahead,
/// filled where somebody looks and enhanced where that is asked for. A difference is computed at
/// most once. Columns are named by the frame that they belong to. Differences are float, or whole
/// numbers of `unit()`s.
class DifferenceSlices {
 public:
  /// @param queries  the frames that columns belong to, more than ds of them; lives longer than
  /// this
  /// @param capacity places of the map, descriptor size
  /// Allocates: from the arena only.
  DifferenceSlices(Arena& arena, const MatcherConfig& config, const QueryHistory& queries,
                   const Capacity& capacity);

  /// The newest frame has the descriptor of the one before it: takes that one's differences, as far
  /// as they are computed. Work: N copies at most. Allocates: never.
  void repeat() noexcept;

  /// Makes sure that the differences of a frame to the rows [first, last) are there; enhanced ones
  /// need those of rwindow / 2 rows on either side too.
  /// @return how many had to be computed. Work: that many times D MACs. Allocates: never.
  std::size_t fill(const PlaceMap& map, std::uint64_t frame, std::size_t first,
                   std::size_t last) noexcept;

  /// Computes the whole columns of the newest frames, which nothing was computed of yet; faster
  /// than one by one: exhaustive search in a map that is in order, not enhanced, by `int8` or by
  /// Euclid's distances of floats.
  /// @param count frames, at most `MatcherConfig::frames_at_once`. Work: count * N distances.
  void fill_newest(const PlaceMap& map, std::size_t count) noexcept;

  /// How many `fill` would have to compute. Work: reads a mark for 64 of them.
  [[nodiscard]] std::size_t missing(const PlaceMap& map, std::uint64_t frame, std::size_t first,
                                    std::size_t last) const noexcept {
    if (first >= last) return 0;
    // As nearly always, and asked for hundreds of times a step.
    if (whole_ && !enhance_ && map.order().straight()) {
      return whole_differences_.missing(frame, first, last);
    }
    return missing_anywhere(map, frame, first, last);
  }

  /// A slot of the map holds another place from now on. Work: ds marks.
  void forget(std::size_t slot) noexcept;

  /// Whether differences are enhanced: where all of them are there, that may be to be done yet.
  [[nodiscard]] bool enhanced() const noexcept { return enhance_; }

  /// Whether differences are whole numbers.
  [[nodiscard]] bool whole() const noexcept { return whole_; }

  /// What a difference of 1 is; 1 for float.
  [[nodiscard]] double unit() const noexcept { return unit_; }

  /// A frame's differences by slot of the map, meaningful where filled: 0 .. 2 between unit
  /// vectors, or what `Contrast` makes of it, in `unit()`s.
  /// @param frame one of the newest ds + 1 frames
  [[nodiscard]] const float* column(std::uint64_t frame, float /*kind*/) const noexcept {
    return (enhance_ ? enhanced_ : exact_).column(frame);
  }
  [[nodiscard]] const std::uint16_t* column(std::uint64_t frame,
                                            std::uint16_t /*kind*/) const noexcept {
    return (enhance_ ? whole_enhanced_ : whole_differences_).column(frame);
  }

  /// A frame's differences row by row, to show.
  /// @param out [map.size()] below zero where nothing was computed
  void show(const PlaceMap& map, std::uint64_t frame, std::span<float> out) const noexcept;

 private:
  [[nodiscard]] std::size_t missing_anywhere(const PlaceMap& map, std::uint64_t frame,
                                             std::size_t first, std::size_t last) const noexcept;

  template <class Value>
  std::size_t fill_in(ColumnRing<Value>& differences, ColumnRing<Value>& enhanced,
                      const PlaceMap& map, std::uint64_t frame, std::size_t first,
                      std::size_t last) noexcept;

  bool whole_;
  bool enhance_;
  Contrast contrast_;
  double unit_;
  const QueryHistory* queries_;
  // Of these four only what the configuration asks for has any memory.
  ColumnRing<float> exact_;
  ColumnRing<float> enhanced_;
  ColumnRing<std::uint16_t> whole_differences_;
  ColumnRing<std::uint16_t> whole_enhanced_;
};

}  // namespace seqloop
