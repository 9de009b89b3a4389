// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace cv {
class Mat;
class VideoCapture;
}  // namespace cv

namespace seqloop::opencv {

/// What reads and writes files of pictures and videos with OpenCV. These parts of OpenCV bring two
/// hundred other libraries with them, so a program may want to load them only once they are needed:
/// everything here goes through this table.
struct FileCodecs {
  /// As cv::imdecode. @param flags cv::IMREAD_…   @return empty where the file is no picture
  cv::Mat (*decode)(std::span<const std::uint8_t> file, int flags);

  /// As cv::imencode. @param ending with its dot: ".png"   @param file replaced by the file's bytes
  /// @return false where the picture cannot be written so
  bool (*encode)(const std::string& ending, const cv::Mat& picture,
                 std::vector<std::uint8_t>& file);

  /// A reader of videos that nothing is opened with yet.
  std::unique_ptr<cv::VideoCapture> (*video)();
};

/// The table of this process, the same each time. Whoever links the library gets one that calls
/// OpenCV. A program may define this function itself, and load what is behind it on the first call;
/// then it throws SetupError where that cannot be loaded. Threads: any.
[[nodiscard]] const FileCodecs& file_codecs();

}  // namespace seqloop::opencv
