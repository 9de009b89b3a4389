// SPDX-License-Identifier: MIT
#include "cost/synthetic_picture.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <random>
#include <stdexcept>

namespace seqloop::cost {
namespace {

constexpr int quality = 85;
constexpr int blocks = 400;

std::vector<std::uint8_t> synthetic_pixels() {
  // Its numbers are the same everywhere, unlike those of the distributions.
  std::mt19937 random(6);
  const auto below = [&](int limit) {
    return static_cast<int>(random() % static_cast<std::uint32_t>(limit));
  };
  std::vector<std::uint8_t> pixels(std::size_t{synthetic_width} * synthetic_height * 3, 90);
  const auto at = [&](int x, int y) {
    return &pixels[(static_cast<std::size_t>(y) * synthetic_width + static_cast<std::size_t>(x)) *
                   3];
  };
  for (int block = 0; block < blocks; ++block) {
    const int left = below(synthetic_width);
    const int top = below(synthetic_height);
    const int right = std::min(left + 4 + below(100), synthetic_width);
    const int bottom = std::min(top + 4 + below(80), synthetic_height);
    const int blue = 20 + below(200);
    const int green = 20 + below(200);
    const int red = 20 + below(200);
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        const int noise = below(12);
        std::uint8_t* const pixel = at(x, y);
        pixel[0] = static_cast<std::uint8_t>(blue + noise);
        pixel[1] = static_cast<std::uint8_t>(green + noise);
        pixel[2] = static_cast<std::uint8_t>(red + noise);
      }
    }
  }
  return pixels;
}

}  // namespace

std::vector<std::uint8_t> synthetic_jpeg() {
  const std::vector<std::uint8_t> pixels = synthetic_pixels();
  const std::unique_ptr<void, decltype(&tjDestroy)> compressor(tjInitCompress(), &tjDestroy);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(compressor.get(), pixels.data(), synthetic_width, 0,
                                 synthetic_height, TJPF_BGR, &bytes, &size, TJSAMP_422, quality, 0);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(bytes, &tjFree);
  if (failed != 0) throw std::runtime_error(tjGetErrorStr2(compressor.get()));
  return {bytes, bytes + size};
}

}  // namespace seqloop::cost
