// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop::opencv {

/// How many threads OpenCV computes with, in the whole process. For programs, not for libraries. A
/// net as small as the built-in one is slower, and its latency scatters, when it is shared out. Any
/// thread may call it; where the count changes, no other thread should be computing with OpenCV.
/// @param count >= 1
void use_threads(int count);

}  // namespace seqloop::opencv
