// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "seqloop/detail/query_history.hpp"

namespace seqloop {

/// How much faster or slower the scene changes at a frame than at the one before it. Source:
/// Eq. (4); src/README.md, section 4.5.
class ChangeDegree {
 public:
  /// Frames that a frame is compared with.
  static constexpr std::size_t reach = 10;

  /// Moves on to the next frame.
  /// @param frame the frame after the last call's, at most `reach` older than what `queries` keeps
  /// @return CD: the sum of its distances to the 10 frames before it, by the same sum one frame
  /// earlier; 1 with fewer than 11 earlier frames and for 0/0, infinity for x/0
  /// Work: 10 distances. Allocates: never.
  double advance(const QueryHistory& queries, std::uint64_t frame) noexcept;

  /// Distances that the last call computed.
  [[nodiscard]] std::size_t distances() const noexcept { return distances_; }

 private:
  std::optional<double> last_sum_;
  std::size_t distances_ = 0;
};

}  // namespace seqloop
