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

  /// What is asked of a frame.
  struct Asked {
    double gain;    ///< by novelty
    double margin;  ///< of its window
  };

  /// @param most what is asked where nothing is known, 0 or more
  /// @return a part of what accepted frames had, 0 .. most; of the margin only where it is less of
  /// the gain: elsewhere frames show enough of their places
  [[nodiscard]] Asked asked(Asked most) const noexcept {
    constexpr double part = 0.4;
    if (novelty_ <= 0.0 || part * gain_ >= most.gain) return most;
    return {std::max(0.0, part * gain_), std::clamp(part * margin_, 0.0, most.margin)};
  }

 private:
  double novelty_ = 0.0;
  double gain_ = 0.0;    // by novelty, mean
  double margin_ = 0.0;  // mean
};

}  // namespace seqloop
