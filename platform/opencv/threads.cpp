// SPDX-License-Identifier: MIT
#include "seqloop/opencv/threads.hpp"

#include <opencv2/core/utility.hpp>

namespace seqloop::opencv {

void use_threads(int count) { cv::setNumThreads(count); }

}  // namespace seqloop::opencv
