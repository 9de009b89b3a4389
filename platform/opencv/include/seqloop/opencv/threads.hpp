// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop::opencv {

/// How many threads OpenCV computes with, in the whole process. For programs, not for libraries. A
/// net as small as the built-in one is slower, and its latency scatters, when it is shared out.
/// @param count >= 1
void use_threads(int count);

}  // namespace seqloop::opencv
