// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "seqloop/opencv/image_folder_source.hpp"
#include "seqloop/turbojpeg/jpeg_file_decoder.hpp"
#include "shared_data.hpp"

namespace seqloop {
namespace {

/// No frame of a real drive is damaged, and each has the pixels that OpenCV reads.
TEST(JpegFileData, RealDrivesHaveOpenCvsPixels) {
  SEQLOOP_DATA_OR_SKIP(shared);
  constexpr std::uint64_t most_compared = 400;  // of a drive; all are read
  for (const char* const drive :
       {"gardens_point/day_left", "gardens_point/night_right", "garage_laps/images"}) {
    SCOPED_TRACE(drive);
    const std::filesystem::path folder = shared / "data" / drive;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".jpg") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    const std::uint64_t step = (files.size() + most_compared - 1) / most_compared;
    opencv::ImageFolderSource source(folder, false, 10.0,
                                     std::make_unique<turbojpeg::JpegFileDecoder>(false));
    Frame frame;
    for (Grab grab = source.grab(frame); grab != Grab::end; grab = source.grab(frame)) {
      ASSERT_EQ(grab, Grab::frame) << frame.fault;
      if (frame.index % step != 0) continue;
      const cv::Mat wanted = cv::imread(files.at(frame.index), cv::IMREAD_COLOR);
      const cv::Mat got(frame.image.height, frame.image.width, CV_8UC3,
                        const_cast<std::uint8_t*>(frame.image.data), frame.image.stride);
      ASSERT_EQ(got.size(), wanted.size());
      ASSERT_EQ(cv::norm(got, wanted, cv::NORM_INF), 0.0) << files.at(frame.index);
    }
    EXPECT_EQ(frame.index, files.size());
  }
}

}  // namespace
}  // namespace seqloop
