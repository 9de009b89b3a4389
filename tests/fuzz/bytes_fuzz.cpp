// SPDX-License-Identifier: MIT
// For libFuzzer: whatever comes from outside as bytes is read or refused, and no memory behind it
// is touched. The first byte says what it is taken for.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "bags/bag_bytes.hpp"
#include "files/npy_header.hpp"
#include "guarded_bytes.hpp"
#include "platform/jpegs.hpp"
#include "ros/pictures.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/opencv/raw_decoder.hpp"
#include "seqloop/ros/odometry.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

namespace seqloop {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t most_bytes = 1 << 16;

/// Guarded, so that reading too far is seen in libraries without a sanitizer as well.
Bytes guarded(Bytes bytes) {
  static test::GuardedBytes memory(most_bytes);
  return memory.hold(bytes.first(std::min(bytes.size(), most_bytes)));
}

void read_every_pixel(const Image& image) {
  const std::size_t row =
      static_cast<std::size_t>(image.width) * (image.format == PixelFormat::gray8 ? 1 : 3);
  volatile std::uint8_t pixel = 0;
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y)
    for (std::size_t x = 0; x < row; ++x) pixel = image.data[y * image.stride + x];
  static_cast<void>(pixel);
}

/// @param bytes format, width, height, padding, pixels
void decode_raw(Bytes bytes) {
  static opencv::RawDecoder gray(true);
  static opencv::RawDecoder colour(false);
  if (bytes.size() < 4) return;
  RawPicture raw;
  raw.format = static_cast<RawFormat>(bytes[0] % 13);
  raw.width = bytes[1];
  raw.height = bytes[2];
  raw.stride = static_cast<std::size_t>(raw.width) * (bytes[3] % 4) + bytes[3] / 4;
  raw.bytes = guarded(bytes.subspan(4));
  for (opencv::RawDecoder* decoder : {&gray, &colour}) {
    Image image;
    if (decoder->decode(raw, image).empty()) read_every_pixel(image);
  }
}

/// @param bytes place in what is good, and what stands there instead
test::Bytes overlaid(test::Bytes good, Bytes bytes) {
  if (bytes.size() < 2) return good;
  std::size_t place = static_cast<std::size_t>(bytes[0] << 8 | bytes[1]) % good.size();
  for (const std::uint8_t byte : bytes.subspan(2))
    if (place < good.size()) good[place++] = byte;
  return good;
}

void decode_mjpg(Bytes bytes) {
  static const test::Bytes good = test::jpeg_of(test::textured(40, 24));
  static turbojpeg::MjpgDecoder decoder({.width = 20, .height = 12});
  Image image;
  const Bytes jpeg = guarded(overlaid(good, bytes));
  if (decoder.decode(test::mjpg(jpeg, 40, 24), image).empty()) read_every_pixel(image);
}

void read_npy(Bytes bytes) {
  static const std::string good = files::make_npy_header(7, 5);
  const Bytes file = guarded(overlaid({good.begin(), good.end()}, bytes));
  const std::span start(static_cast<const char*>(static_cast<const void*>(file.data())),
                        file.size());
  try {
    const std::uint64_t offset =
        files::npy_data_offset(start.first(files::npy_preamble_bytes), "fuzz");
    if (offset > start.size()) return;
    static_cast<void>(
        files::parse_npy_header(start.first(static_cast<std::size_t>(offset)), "fuzz"));
  } catch (const SetupError&) {  // refused
  }
}

/// A message of ROS 2, and the picture that it says it holds.
void read_message(Bytes bytes) {
  static const test::Bytes pixels(3 * 4 * 2, 7);
  static const test::Bytes good = test::image_message(1, 4, 2, "rgb8", 12, pixels);
  static opencv::RawDecoder decoder(false);
  const Bytes message = guarded(overlaid(good, bytes));
  static_cast<void>(ros::read_odometry(message));
  for (const auto type : {ros::PictureType::image, ros::PictureType::compressed}) {
    FixedText fault;
    const RawPicture picture = ros::read_picture(type, message, fault).picture;
    Image image;
    const bool raw = fault.empty() && type == ros::PictureType::image;
    if (raw && decoder.decode(picture, image).empty()) read_every_pixel(image);
  }
}

}  // namespace
}  // namespace seqloop

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span bytes(data + 1, size - 1);
  if (data[0] % 4 == 0) seqloop::decode_raw(bytes);
  if (data[0] % 4 == 1) seqloop::decode_mjpg(bytes);
  if (data[0] % 4 == 2) seqloop::read_npy(bytes);
  if (data[0] % 4 == 3) seqloop::read_message(bytes);
  return 0;
}
