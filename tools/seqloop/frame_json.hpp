#pragma once

#include <cstdint>
#include <string>

#include "seqloop/pipeline.hpp"

namespace seqloop::program {

/// One line of `run`'s output, newline included. What a frame does not have is null.
[[nodiscard]] std::string frame_json(const ProcessedFrame& processed, bool deadline_missed);

}  // namespace seqloop::program
