// SPDX-License-Identifier: MIT
#include "seqloop/opencv/silence.hpp"

#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>

namespace seqloop::opencv {

void silence_opencv() {
  if (std::getenv("OPENCV_LOG_LEVEL") == nullptr)
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);  // AV_LOG_QUIET; read when the first video is opened
}

}  // namespace seqloop::opencv
