// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "platform/jpegs.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"
#include "shared_data.hpp"

namespace seqloop {
namespace {

test::Bytes read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

double distance(const std::vector<float>& one, const std::vector<float>& other) {
  double squares = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i)
    squares += std::pow(static_cast<double>(one[i]) - static_cast<double>(other[i]), 2);
  return std::sqrt(squares);
}

/// Neighbouring frames of these drives are 0.46 apart, day and night of a place 0.68.
TEST(MjpgDecoderData, ReducedGrayPicturesGiveNearlyTheSameDescriptors) {
  SEQLOOP_DATA_OR_SKIP(shared);
  const auto describer = opencv::make_builtin_describer();
  turbojpeg::MjpgDecoder decoder(describer->needs());
  std::vector<float> whole(describer->size());
  std::vector<float> reduced(describer->size());
  for (const char* const drive : {"day_left", "night_right"}) {
    double farthest = 0.0;
    std::size_t frames = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(shared / "data/gardens_point" / drive)) {
      if (entry.path().extension() != ".jpg") continue;
      const test::Bytes jpeg = read(entry.path());
      const cv::Mat picture = cv::imdecode(jpeg, cv::IMREAD_COLOR);
      Image image;
      ASSERT_EQ(decoder.decode(test::mjpg(jpeg, picture.cols, picture.rows), image), "")
          << entry.path();
      ASSERT_LE(image.width, picture.cols / 2);
      ASSERT_EQ(describer->describe(test::image_of(picture), whole), Description::good);
      ASSERT_EQ(describer->describe(image, reduced), Description::good);
      farthest = std::max(farthest, distance(whole, reduced));
      ++frames;
    }
    std::printf("%s: %zu frames, at most %.3f apart\n", drive, frames, farthest);
    EXPECT_EQ(frames, 200U);
    EXPECT_LE(farthest, 0.25);
  }
}

}  // namespace
}  // namespace seqloop
