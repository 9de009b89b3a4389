// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "seqloop/detail/kept_row.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// How often a robot is carried away while it localises: by the accepted answers that no drive
/// leads on to from those before them. One that never was is trusted as if it never will be.
/// Rows do not go from a map that is localised in.
/// Source: src/README.md, section 6.6.
class JumpRate {
 public:
  /// Takes an accepted answer. Those of frames before one that was taken already are passed over.
  /// @param row    where the robot was, of the map
  /// @param known_from the first frame from which the way to this one is known
  /// Work: log sessions. Allocates: never.
  void take(const PlaceMap& map, std::uint64_t frame, std::size_t row,
            std::uint64_t known_from) noexcept;

  /// Where the robot was found.
  struct Found {
    std::uint64_t frame;
    std::size_t row;
  };

  /// By the answer that was taken last; none: there was none.
  [[nodiscard]] const std::optional<Found>& last() const noexcept { return last_; }

  /// The chance that the robot is carried away with a frame, 0 .. 0.5: 0 where it never was, else
  /// 14 times as often as it was seen to be. Windows overlap, so that frames on either side of a
  /// jump say more for one trace than they know.
  [[nodiscard]] double chance() const noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept {
    if (last_) count_with(row, last_->row);
  }

 private:
  std::optional<Found> last_;
  std::uint64_t answers_ = 0;
  std::uint64_t jumps_ = 0;
};

}  // namespace seqloop
