// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace seqloop::cost {

/// What it costs a frame, on average, that a run is shown.
struct ServingCost {
  std::uint64_t publish = 0;      ///< instructions of the loop's thread: handing a frame over
  std::uint64_t serve = 0;        ///< of the server's threads, without the kernel's for them
  std::uint64_t with_kernel = 0;  ///< the same with them
  std::uint64_t bytes = 0;        ///< that all clients together receive
};

/// Counts over 20 seconds of 30 frames, one answer a frame and the synthetic picture.
/// @param clients processes that do as the page does: every event, the loops, the newest picture
/// Listens on 127.0.0.1:8321. Throws SetupError where that, or counting, cannot be done.
[[nodiscard]] ServingCost count_serving(std::size_t clients);

}  // namespace seqloop::cost
