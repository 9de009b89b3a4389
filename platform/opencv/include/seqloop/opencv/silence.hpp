// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop::opencv {

/// Stops OpenCV and its FFmpeg backend from writing to stderr by themselves; what matters is in our
/// own messages. For programs, not for libraries: it sets the process' log level and environment,
/// so it has to be called before any thread is started and any video opened. What the user has set
/// in OPENCV_LOG_LEVEL or OPENCV_FFMPEG_LOGLEVEL stays.
void silence_opencv();

}  // namespace seqloop::opencv
