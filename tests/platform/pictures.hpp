// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "seqloop/frame.hpp"
#include "temporary_folder.hpp"

namespace seqloop::test {

/// What a source or describer sees of an OpenCV picture, 8-bit grey or BGR.
inline Image image_of(const cv::Mat& picture) {
  return {picture.data, picture.cols, picture.rows, picture.step[0],
          picture.channels() == 1 ? PixelFormat::gray8 : PixelFormat::bgr8};
}

/// A picture with blobs in it, which every format can hold.
inline cv::Mat textured(int width, int height, std::uint64_t seed = 1, int type = CV_8UC3) {
  cv::Mat picture(height, width, type);
  cv::RNG random(seed);
  random.fill(picture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(picture, picture, cv::Size(5, 5), 0.0);
  return picture;
}

inline std::string encoded(const cv::Mat& picture, const std::string& extension) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

/// A drive of so many pictures, 96 by 64, each of another place.
inline void write_pictures(const TemporaryFolder& folder, const std::string& name,
                           std::uint64_t count) {
  std::filesystem::create_directory(folder.path() / name);
  for (std::uint64_t n = 0; n < count; ++n) {
    folder.write(name + "/" + std::to_string(n) + ".png", encoded(textured(96, 64, n + 1), ".png"));
  }
}

/// Some bytes changed, taken out or put in.
inline std::string mutated(std::string file, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  for (std::size_t change = below(6) + 1; change-- > 0 && !file.empty();) {
    const std::size_t place = below(file.size());
    switch (below(5)) {
      case 0:
        file.erase(place, below(8) + 1);
        break;
      case 1:
        file.insert(place, 1, static_cast<char>(below(256)));
        break;
      case 2:
        if (below(8) == 0) file.resize(place);
        break;
      default:
        file[place] = static_cast<char>(below(256));
    }
  }
  return file;
}

}  // namespace seqloop::test
