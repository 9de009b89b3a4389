// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "program/process/progress.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop::program {

/// When a drive counts as described before it is over.
struct DescribeUntil {
  std::size_t rows = 0;      ///< 0: any number
  bool interrupted = false;  ///< an interruption ends a live drive, and the rows are kept;
                             ///< otherwise it is the end of everything
};

/// Takes the descriptors of a drive, [D] each.
using DescriptorSink = std::function<void(std::span<const float>)>;

/// Rows, and frames that are not like the others.
struct DescribedCount {
  std::size_t rows = 0;
  std::size_t unreadable = 0;  ///< rows of zeros, which keep the rows in step with the frames
  std::size_t missing = 0;     ///< likewise, of frames lost or dropped, up to 1,000 a gap
  std::size_t blank = 0;       ///< without any feature
};

/// Hands over the descriptor of every frame of a drive, one row each.
/// @param name of the drive, for messages
/// Throws SetupError when no frame can be read, what `out` throws, and when the program is
/// interrupted where that is not the end that `until` wants.
DescribedCount describe_drive(const std::string& name, FrameSource& source, Describer& describer,
                              const DescriptorSink& out, Progress& progress,
                              const DescribeUntil& until = {});

}  // namespace seqloop::program
