// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace seqloop {

/// A line through sums along diagonals, as offsets into one array: the whole sum of the diagonal
/// that it ends on; and where it changed from a diagonal to the next one, what the two had apart
/// there, added where it rises and taken off where it falls.
struct LineThroughSums {
  std::uint32_t end;
  std::uint32_t first_change;  // among the changes of all lines
  std::uint32_t last_change;   // left out
  bool rises;
};

}  // namespace seqloop
