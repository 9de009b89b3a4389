// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>

namespace seqloop {

/// What is kept of a row that has gone from the map: none.
template <class Row>
inline constexpr Row gone = std::numeric_limits<Row>::max();

/// A row went from the map: what is kept of those behind it is counted one lower.
/// @param forgotten as `PlaceMap::Taken` has it: the row is gone for good; otherwise the next row
/// shows much the same
template <class Row>
void count_without(std::size_t row, bool forgotten, Row& kept) noexcept {
  if (kept == gone<Row>) return;
  if (kept > row) {
    --kept;
  } else if (kept == row && forgotten) {
    kept = gone<Row>;
  }
}

/// A row came into the map: those from it on are counted one higher.
template <class Row>
void count_with(std::size_t row, Row& kept) noexcept {
  if (kept >= row && kept != gone<Row>) ++kept;
}

}  // namespace seqloop
