// SPDX-License-Identifier: MIT
#include "program/drives/warm_up.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include "program/process/interruption.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/turbojpeg/encode_jpeg.hpp"

namespace seqloop::program {
namespace {

constexpr int rounds = 3;  // the second one finds every buffer made; the third is for caches
constexpr std::size_t small_descriptor = 64;  // the path through the matcher does not depend on it

void describe_noise(Describer& describer, std::mt19937& random) {
  constexpr int width = 640;
  constexpr int height = 480;
  std::vector<std::uint8_t> pixels(std::size_t{width} * height);
  std::ranges::generate(pixels, [&] { return static_cast<std::uint8_t>(random()); });
  std::vector<float> descriptor(describer.size());
  const Image picture{pixels.data(), width, height, width, PixelFormat::gray8};
  for (int round = 0; round < rounds; ++round) {
    static_cast<void>(describer.describe(picture, descriptor));
  }
}

/// A grey picture as a camera sends it.
std::vector<std::uint8_t> sent_as(RawFormat format, int width, int height) {
  constexpr std::uint8_t middle_gray = 128;  // of luma and of both chroma planes
  if (format != RawFormat::mjpg) {
    return std::vector<std::uint8_t>(bytes_of(format, row_bytes(format, width), height),
                                     middle_gray);
  }
  const std::size_t row = std::size_t{3} * static_cast<std::size_t>(width);
  const std::vector<std::uint8_t> pixels(row * static_cast<std::size_t>(height), middle_gray);
  constexpr int quality = 95;
  return turbojpeg::encode_jpeg({pixels.data(), width, height, row, PixelFormat::bgr8}, quality);
}

void match_noise(MatcherConfig config, std::size_t descriptor_size, std::mt19937& random) {
  // However wide they are set, the code is the same, and each row costs a frame here.
  const MatcherConfig usual;
  config.exclude = std::min(config.exclude, usual.exclude);
  config.rwindow = std::min(config.rwindow, usual.rwindow);
  const std::size_t window = config.sequence_length + 1;
  const bool closing = config.use == Use::close_loops;
  const std::size_t places =
      std::max(least_places(config), (closing ? config.exclude : 0) + 3 * window + config.rwindow);
  const std::size_t size = std::min(descriptor_size, small_descriptor);
  std::uniform_real_distribution<float> values(0.1F, 1.0F);
  std::vector<float> descriptor(size);
  const auto next = [&] {
    std::ranges::generate(descriptor, [&] { return values(random); });
    normalise(descriptor);
    return std::span<const float>(descriptor);
  };
  PlaceMap map(config, {places, size});
  map.set_columns(size);  // any will do
  if (!closing) {
    while (!interrupted() && map.add(next())) {
    }
  }
  Detector detector(config, map);
  for (std::size_t frame = 0; frame < places && !interrupted(); ++frame) {
    static_cast<void>(detector.step(next()));
    if (frame == places / 2) detector.skip(1);
  }
  static_cast<void>(detector.step({}));
  static_cast<void>(detector.finish());
}

}  // namespace

void warm_up(Describer* describer, const MatcherConfig& config, std::size_t descriptor_size) {
  std::mt19937 random(1);
  if (describer != nullptr) describe_noise(*describer, random);
  match_noise(config, descriptor_size, random);
}

void warm_up(PictureDecoder& decoder, Describer& describer, RawFormat format, int width,
             int height) {
  const std::vector<std::uint8_t> bytes = sent_as(format, width, height);
  const RawPicture raw{bytes, width, height, row_bytes(format, width), format};
  std::vector<float> descriptor(describer.size());
  for (int round = 0; round < rounds; ++round) {
    Image picture;
    if (!decoder.decode(raw, picture).empty()) return;
    static_cast<void>(describer.describe(picture, descriptor));
  }
}

}  // namespace seqloop::program
