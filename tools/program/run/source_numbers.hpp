// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "seqloop/pipeline.hpp"

namespace seqloop::program {

/// The source's own numbers of the frames that a detector has counted: the detector leaves long
/// gaps out (`Detector::skip`), and a live source's first frame may not be its number 0.
class SourceNumbers {
 public:
  /// @param window frames that an answer looks back on, ds + 1
  /// @param places room in a map that the drive itself makes; 0 where it is localised in another
  SourceNumbers(std::size_t window, std::size_t places) : recent_(window), places_(places) {}

  /// Notes a processed frame, and puts the source's numbers into its report: `newest`, `frame`, and
  /// where loops are closed, the match's `place` and `head`. Nothing changes at the gate
  /// `no_frame`. Work: frames since the last call. Allocates: never.
  void rename(ProcessedFrame& processed) noexcept;

 private:
  std::vector<std::uint64_t> recent_;  // [window] by the detector's number, modulo the window
  std::vector<std::uint64_t> places_;  // [places]
  std::uint64_t counted_ = 0;          // frames that the detector has counted
};

}  // namespace seqloop::program
