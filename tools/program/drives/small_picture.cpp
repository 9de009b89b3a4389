// SPDX-License-Identifier: MIT
#include "program/drives/small_picture.hpp"

#include <algorithm>

namespace seqloop::program {
namespace {

/// Every n-th pixel of a row. A pixel's size is known here, so that copying one is no call.
template <std::size_t channels>
std::uint8_t* pick(const std::uint8_t* in, std::size_t step, int count,
                   std::uint8_t* out) noexcept {
  for (int x = 0; x < count; ++x, in += step * channels, out += channels) {
    for (std::size_t c = 0; c < channels; ++c) out[c] = in[c];
  }
  return out;
}

}  // namespace

bool shrink(const Image& image, std::uint64_t number, int most_width, int most_height,
            SmallPictureFacts& facts, std::span<std::uint8_t> pixels) noexcept {
  if (image.data == nullptr || image.width <= 0 || image.height <= 0) return false;
  const int step = std::max({1, (image.width + most_width - 1) / most_width,
                             (image.height + most_height - 1) / most_height});
  facts.number = number;
  facts.width = image.width / step;
  facts.height = image.height / step;
  if (facts.width == 0 || facts.height == 0) return false;
  facts.gray = image.format == PixelFormat::gray8;
  const std::size_t channels = facts.gray ? 1 : 3;
  std::uint8_t* out = pixels.data();
  for (int y = 0; y < facts.height; ++y) {
    const std::uint8_t* in = image.data +
                             static_cast<std::size_t>(y * step + step / 2) * image.stride +
                             static_cast<std::size_t>(step / 2) * channels;
    const auto n = static_cast<std::size_t>(step);
    out = facts.gray ? pick<1>(in, n, facts.width, out) : pick<3>(in, n, facts.width, out);
  }
  return true;
}

}  // namespace seqloop::program
