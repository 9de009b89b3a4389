// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "seqloop/matcher_config.hpp"
#include "seqloop/pipeline.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// The source's own numbers of the frames that a detector has counted: the detector leaves long
/// gaps out (`Detector::skip`), and a live source's first frame may not be its number 0.
class SourceNumbers {
 public:
  /// @param map which the drive itself makes, and which lives longer; null where it is localised in
  /// another
  SourceNumbers(const MatcherConfig& config, const PlaceMap* map);

  /// Notes a frame that the detector has just taken, and puts the source's numbers into its report:
  /// `newest`, `frame`, those of its answers and, where loops are closed, those of places. Nothing
  /// changes at the gate `no_frame`.
  /// Work: frames and places since the last call; log N a place that is told. Allocates: never.
  void rename(ProcessedFrame& processed) noexcept;

  /// @param answers of the detector's `finish`
  /// @return the same with the source's numbers; they stand until the next call
  [[nodiscard]] std::span<const Answer> rename(std::span<const Answer> answers) noexcept;

 private:
  void note(std::uint64_t newest, std::uint64_t index) noexcept;
  [[nodiscard]] std::uint64_t frame(std::uint64_t counted) const noexcept;
  [[nodiscard]] std::uint64_t place(std::uint64_t number) const noexcept;
  void rename(std::optional<Match>& match) const noexcept;

  const PlaceMap* map_;
  std::vector<std::uint64_t> recent_;  // by the detector's number, modulo as many as still matter
  std::vector<std::uint64_t> places_;  // by slot of the map
  std::vector<Answer> answers_;
  std::uint64_t counted_ = 0;     // frames that the detector has counted
  std::uint64_t next_place_ = 0;  // number of the place that is noted next, or less
};

}  // namespace seqloop::program
