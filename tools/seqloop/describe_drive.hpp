#pragma once

#include <cstddef>

#include "files/npy_file.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/progress.hpp"

namespace seqloop::program {

/// Frames that are not like the others.
struct DescribedCount {
  std::size_t unreadable = 0;  ///< rows of zeros, which keep the rows in step with the frames
  std::size_t blank = 0;       ///< without any feature
};

/// Writes the descriptor of every frame of a drive, one row each, and commits.
/// @param name of the drive, for messages
/// Throws SetupError when no frame can be read, files::IoError, and when the program is
/// interrupted.
DescribedCount describe_drive(const std::string& name, FrameSource& source, Describer& describer,
                              files::NpyWriter& out, Progress& progress);

}  // namespace seqloop::program
