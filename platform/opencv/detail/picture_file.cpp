// SPDX-License-Identifier: MIT
#include "opencv/detail/picture_file.hpp"

#include <algorithm>
#include <array>

namespace seqloop::opencv {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 3> jpeg_start{0xff, 0xd8, 0xff};
constexpr std::array<std::uint8_t, 8> png_start{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::array<std::uint8_t, 2> jpeg_end{0xff, 0xd9};
constexpr std::uint64_t most_pixels = 200'000'000;  // largest camera sensors; 0.6 GB when decoded

constexpr std::string_view truncated = "the file is truncated";
constexpr std::string_view too_large = "the picture has more than 200 million pixels";

template <std::size_t size>
bool starts_with(Bytes bytes, const std::array<std::uint8_t, size>& start) {
  return bytes.size() >= size && std::equal(start.begin(), start.end(), bytes.begin());
}

/// @return 0 where the file is too short
std::uint64_t big_endian(Bytes bytes, std::size_t place, std::size_t count) {
  if (place > bytes.size() || count > bytes.size() - place) return 0;
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes.subspan(place, count)) value = value << 8 | byte;
  return value;
}

/// A start-of-frame marker, which holds the size (DHT, JPG and DAC lie among them).
bool is_frame(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// Walks the segments up to the picture's data, because an embedded thumbnail has an end of its
/// own.
std::string_view jpeg_fault(Bytes file) {
  std::size_t place = 2;
  while (true) {
    if (place + 4 > file.size()) return truncated;
    if (file[place] != 0xff) return {};  // not a well-formed JPEG: the decoder's business
    const std::uint8_t marker = file[place + 1];
    if (marker == 0xff) {  // padding
      ++place;
      continue;
    }
    if (is_frame(marker) &&
        big_endian(file, place + 5, 2) * big_endian(file, place + 7, 2) > most_pixels)
      return too_large;
    place += 2 + static_cast<std::size_t>(big_endian(file, place + 2, 2));
    if (place >= file.size()) return truncated;
    if (marker == 0xda) break;  // start of scan
  }
  const Bytes data = file.subspan(place);
  // Searched from behind: some cameras append data of their own.
  const auto end = std::find_end(data.begin(), data.end(), jpeg_end.begin(), jpeg_end.end());
  return end == data.end() ? truncated : std::string_view();
}

std::string_view png_fault(Bytes file) {
  constexpr std::size_t header_place = png_start.size();  // IHDR: length, type, width, height
  if (big_endian(file, header_place + 8, 4) * big_endian(file, header_place + 12, 4) > most_pixels)
    return too_large;
  std::uint64_t place = header_place;
  while (place + 12 <= file.size()) {  // a chunk has 12 bytes besides its data
    if (big_endian(file, static_cast<std::size_t>(place) + 4, 4) == 0x49454e44) return {};  // IEND
    place += 12 + big_endian(file, static_cast<std::size_t>(place), 4);
  }
  return truncated;
}

}  // namespace

std::string_view picture_file_fault(Bytes file) noexcept {
  if (file.empty()) return "the file is empty";
  if (starts_with(file, jpeg_start)) return jpeg_fault(file);
  if (starts_with(file, png_start)) return png_fault(file);
  return {};
}

}  // namespace seqloop::opencv
