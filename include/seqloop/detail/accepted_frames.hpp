// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

namespace seqloop {

/// What the frames of accepted answers usually show of their places. A camera that sees little, or
/// frames that were taken between the map's, gain less than those of other drives though they are
/// right: where a trace is beyond doubt, no more than a part of that is asked of its frames.
/// Source: src/README.md, section 6.6.
class AcceptedFrames {
 public:
  /// Takes a frame whose answer was accepted.
  /// @param gain    ln of how much likelier it is at its place than somewhere new
  /// @param novelty 0 .. 1; nothing is learnt of a frame without any
  /// @param margin  of its window
  /// Allocates: never.
  void take(double gain, double novelty, double margin) noexcept {
    if (novelty <= 0.0) return;
    constexpr double longest = 40.0;  // novel frames that the means are of
    novelty_ = std::min(longest, novelty_ + novelty);
    const double share = novelty / novelty_;
    gain_ += share * (gain / novelty - gain_);
    margin_ += share * (margin - margin_);
  }

  /// @param most by novelty, 0 or more. @return what a frame has to gain, 0 .. most
  [[nodiscard]] double least_gain(double most) const noexcept { return least(gain_, most); }

  /// @param most 0 or more. @return the same of the margin of its window
  [[nodiscard]] double least_margin(double most) const noexcept { return least(margin_, most); }

 private:
  [[nodiscard]] double least(double usual, double most) const noexcept {
    constexpr double part = 0.4;
    return novelty_ > 0.0 ? std::clamp(part * usual, 0.0, most) : most;
  }

  double novelty_ = 0.0;
  double gain_ = 0.0;    // by novelty, mean
  double margin_ = 0.0;  // mean
};

}  // namespace seqloop
