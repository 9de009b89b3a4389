// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <span>
#include <string>

#include "seqloop/frame_source.hpp"

namespace seqloop::opencv {

/// What training drives brought.
struct TrainingCount {
  std::size_t pictures = 0;
  std::size_t unreadable = 0;  ///< frames that were left out
};

/// Hands over every picture of the drives, in order; frames that cannot be read or are no pictures
/// are left out. What OpenCV throws meanwhile becomes a SetupError.
TrainingCount for_each_picture(std::span<FrameSource* const> drives,
                               const std::function<void(const Image&)>& visit);

/// "5 pictures that can be read and 2 that cannot"
[[nodiscard]] std::string text(const TrainingCount& count);

}  // namespace seqloop::opencv
