// SPDX-License-Identifier: MIT
#include "seqloop/opencv/threads.hpp"

#include <mutex>
#include <opencv2/core/utility.hpp>

namespace seqloop::opencv {

void use_threads(int count) {
  // OpenCV takes its pool down and makes it anew, even for the same count: two callers at once
  // crash it, and so may one while another computes.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  if (cv::getNumThreads() != count) cv::setNumThreads(count);
}

}  // namespace seqloop::opencv
