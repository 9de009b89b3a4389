// SPDX-License-Identifier: MIT
// By itself: who only takes pictures along needs no encoder.
#include <vector>

#include "program/drives/small_picture.hpp"
#include "seqloop/turbojpeg/encode_jpeg.hpp"

namespace seqloop::program {

std::string jpeg(const SmallPictureFacts& facts, std::span<const std::uint8_t> pixels,
                 int quality) {
  const PixelFormat format = facts.gray ? PixelFormat::gray8 : PixelFormat::bgr8;
  const std::size_t row = static_cast<std::size_t>(facts.width) * (facts.gray ? 1U : 3U);
  const std::vector<std::uint8_t> bytes =
      turbojpeg::encode_jpeg({pixels.data(), facts.width, facts.height, row, format}, quality);
  return {bytes.begin(), bytes.end()};
}

}  // namespace seqloop::program
