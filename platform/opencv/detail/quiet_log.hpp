// SPDX-License-Identifier: MIT
#pragma once

#include <opencv2/core/utils/logger.hpp>

namespace seqloop::opencv {

/// Keeps OpenCV's log silent in its scope: what it would say there is said by a SetupError. The
/// level belongs to the whole process and other threads are silenced meanwhile, so this is for
/// set-up only.
class QuietLog {
 public:
  QuietLog() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;
  QuietLog(QuietLog&&) = delete;
  QuietLog& operator=(QuietLog&&) = delete;
  ~QuietLog() { cv::utils::logging::setLogLevel(before_); }

 private:
  cv::utils::logging::LogLevel before_;
};

}  // namespace seqloop::opencv
