// SPDX-License-Identifier: MIT
#include "ros/pictures.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "ros/cdr.hpp"

namespace seqloop::ros {
namespace {

struct Encoding {
  std::string_view name;
  RawFormat format;
};

// As sensor_msgs/image_encodings.hpp has them; `yuv422` is the old name of `uyvy`.
constexpr std::array encodings{
    Encoding{"mono8", RawFormat::gray8},      Encoding{"rgb8", RawFormat::rgb8},
    Encoding{"bgr8", RawFormat::bgr8},        Encoding{"rgba8", RawFormat::rgba8},
    Encoding{"bgra8", RawFormat::bgra8},      Encoding{"mono16", RawFormat::gray16},
    Encoding{"yuv422_yuy2", RawFormat::yuyv}, Encoding{"yuyv", RawFormat::yuyv},
    Encoding{"yuv422", RawFormat::uyvy},      Encoding{"uyvy", RawFormat::uyvy},
    Encoding{"8UC1", RawFormat::gray8},       Encoding{"8UC3", RawFormat::bgr8},
    Encoding{"16UC1", RawFormat::gray16},
};

std::optional<RawFormat> format_of(std::string_view encoding) {
  const auto* const found = std::ranges::find(encodings, encoding, &Encoding::name);
  if (found == encodings.end()) return std::nullopt;
  return found->format;
}

void read_image(CdrReader& cdr, RawPicture& picture, FixedText& fault) {
  const auto height = cdr.number<std::uint32_t>();
  const auto width = cdr.number<std::uint32_t>();
  const std::string_view encoding = cdr.text();
  const bool big_endian = cdr.number<std::uint8_t>() != 0;
  picture.stride = cdr.number<std::uint32_t>();
  picture.bytes = cdr.octets();
  if (!cdr.fault().empty()) return;
  constexpr auto most = static_cast<std::uint32_t>(std::numeric_limits<int>::max());
  const std::optional<RawFormat> format = format_of(encoding);
  if (!format) {
    fault.assign({"pictures of the encoding '", encoding.substr(0, 40),
                  "' are not read, only mono8, mono16, rgb8, bgr8, rgba8, bgra8 and YUV 4:2:2"});
  } else if (height > most || width > most) {
    fault.assign({"no picture is as large as it says"});
  } else {
    picture.height = static_cast<int>(height);
    picture.width = static_cast<int>(width);
    picture.format = *format == RawFormat::gray16 && big_endian ? RawFormat::gray16be : *format;
  }
}

void read_compressed(CdrReader& cdr, RawPicture& picture, FixedText& fault) {
  constexpr std::array<std::uint8_t, 3> jpeg{0xff, 0xd8, 0xff};
  constexpr std::array<std::uint8_t, 4> png{0x89, 'P', 'N', 'G'};
  const std::string_view format = cdr.text();
  picture.bytes = cdr.octets();
  if (!cdr.fault().empty()) return;
  const auto starts_with = [&](const auto& start) {
    return picture.bytes.size() >= start.size() &&
           std::equal(start.begin(), start.end(), picture.bytes.begin());
  };
  // The bytes tell more surely than the words, which every publisher writes in its own way.
  if (starts_with(jpeg)) {
    picture.format = RawFormat::mjpg;
  } else if (starts_with(png)) {
    picture.format = RawFormat::png;
  } else {
    fault.assign({"the compressed picture ('", format.substr(0, 40), "') is neither JPEG nor PNG"});
  }
}

}  // namespace

PictureType picture_type(std::string_view type) noexcept {
  if (type == "sensor_msgs/msg/Image" || type == "sensor_msgs/Image") return PictureType::image;
  if (type == "sensor_msgs/msg/CompressedImage" || type == "sensor_msgs/CompressedImage")
    return PictureType::compressed;
  return PictureType::none;
}

PictureMessage read_picture(PictureType type, std::span<const std::uint8_t> message,
                            FixedText& fault) noexcept {
  fault.clear();
  CdrReader cdr(message);
  PictureMessage read{cdr.stamp(), {}};
  if (type == PictureType::compressed) {
    read_compressed(cdr, read.picture, fault);
  } else {
    read_image(cdr, read.picture, fault);
  }
  if (!cdr.fault().empty()) fault.assign({cdr.fault()});
  if (!fault.empty()) read.picture = {};
  return read;
}

}  // namespace seqloop::ros
