// SPDX-License-Identifier: MIT
#include "turbojpeg/detail/jpeg_header.hpp"

#include <cstddef>

namespace seqloop::turbojpeg {
namespace {

using Bytes = std::span<const std::uint8_t>;

namespace marker {
constexpr std::uint8_t fill = 0xff;
constexpr std::uint8_t baseline = 0xc0;  // the first of 16 kinds of frames
constexpr std::uint8_t extended = 0xc1;  // sequential as well
constexpr std::uint8_t last_frame = 0xcf;
constexpr std::uint8_t huffman_tables = 0xc4;
constexpr std::uint8_t arithmetic_tables = 0xcc;
constexpr std::uint8_t first_without_length = 0xd0;  // restarts, start and end of a picture
constexpr std::uint8_t last_without_length = 0xd9;
constexpr std::uint8_t scan = 0xda;
constexpr std::uint8_t segments = 0xc0;  // none below has a meaning
}  // namespace marker

constexpr std::string_view damaged = "the JPEG picture is damaged before its data begin";

bool is_frame(std::uint8_t code) {
  return code >= marker::baseline && code <= marker::last_frame && code != marker::huffman_tables &&
         code != marker::arithmetic_tables;
}

int big_endian(Bytes bytes, std::size_t place) { return bytes[place] << 8 | bytes[place + 1]; }

/// @param content of a frame's segment, without its length
std::string_view read_frame(std::uint8_t code, Bytes content, JpegHeader& header) {
  if (code != marker::baseline && code != marker::extended)
    return "the JPEG picture is progressive, lossless or arithmetically coded; cameras send "
           "baseline JPEG";
  if (content.size() < 6) return damaged;
  if (content[0] != 8) return "the JPEG picture has other than 8 bits a colour";
  header = {big_endian(content, 3), big_endian(content, 1), content[5]};
  if (header.components != 1 && header.components != 3)
    return "the JPEG picture is neither grey nor of three colours";
  if (header.width == 0 || header.height == 0) return "the JPEG picture does not say its size";
  return {};
}

/// @param content of a scan's segment, without its length
std::string_view check_scan(Bytes content, const JpegHeader& header) {
  if (header.components == 0 || content.empty()) return damaged;
  if (content[0] != header.components) return "the JPEG picture's colours come one by one";
  return {};
}

}  // namespace

std::string_view read_jpeg_header(Bytes bytes, JpegHeader& header) noexcept {
  constexpr std::string_view truncated = "the JPEG picture ends before its data begin";
  if (bytes.size() < 2 || bytes[0] != 0xff || bytes[1] != 0xd8)
    return "the frame is no JPEG picture: it does not begin with FF D8";
  JpegHeader found;
  std::size_t place = 2;
  while (true) {
    if (bytes.size() - place < 4) return truncated;
    if (bytes[place] != marker::fill) return damaged;
    const std::uint8_t code = bytes[place + 1];
    if (code == marker::fill) {
      ++place;
      continue;
    }
    if (code < marker::segments ||
        (code >= marker::first_without_length && code <= marker::last_without_length))
      return damaged;
    const auto length = static_cast<std::size_t>(big_endian(bytes, place + 2));
    if (length < 2) return damaged;
    if (length > bytes.size() - place - 2) return truncated;
    const Bytes content = bytes.subspan(place + 4, length - 2);
    std::string_view fault;
    if (is_frame(code)) fault = read_frame(code, content, found);
    if (code == marker::scan) fault = check_scan(content, found);
    if (!fault.empty()) return fault;
    if (code == marker::scan) break;
    place += 2 + length;
  }
  header = found;
  return {};
}

}  // namespace seqloop::turbojpeg
