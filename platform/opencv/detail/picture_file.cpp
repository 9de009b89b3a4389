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
constexpr std::array<std::uint8_t, 6> exif_start{'E', 'x', 'i', 'f', 0, 0};
constexpr std::uint64_t most_pixels = 200'000'000;  // largest camera sensors; 0.6 GB when decoded

constexpr std::string_view truncated = "the file is truncated";
constexpr std::string_view too_large = "the picture has more than 200 million pixels";

/// Each goes over the whole picture, however few bytes it has. libjpeg writes 10, or 18 of four
/// inks; mozjpeg chooses from 64.
constexpr int most_scans = 64;
constexpr std::string_view too_many_scans =
    "the JPEG picture has more than 64 scans, which take too long to decode; encode it anew";

template <std::size_t size>
bool starts_with(Bytes bytes, const std::array<std::uint8_t, size>& start) {
  return bytes.size() >= size && std::equal(start.begin(), start.end(), bytes.begin());
}

/// @return 0 where the file is too short
std::uint64_t big_endian(Bytes bytes, std::uint64_t place, std::size_t count) {
  if (place > bytes.size() || count > bytes.size() - place) return 0;
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes.subspan(static_cast<std::size_t>(place), count))
    value = value << 8 | byte;
  return value;
}

/// A start-of-frame marker, which holds the size (DHT, JPG and DAC lie among them).
bool is_frame(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// @param tiff EXIF's data
/// @return its orientation; 1 where it does not say one
int orientation_in(Bytes tiff) {
  constexpr std::uint64_t orientation_tag = 0x0112;
  constexpr std::size_t entry_bytes = 12;  // tag, type, count, value
  const bool little = !tiff.empty() && tiff[0] == 'I';
  const auto number = [&](std::uint64_t place, std::size_t count) {
    const std::uint64_t value = big_endian(tiff, place, count);
    if (!little) return value;
    return count == 2 ? (value >> 8 | (value & 0xff) << 8)
                      : (value >> 24 | (value >> 8 & 0xff00) | (value & 0xff00) << 8 |
                         (value & 0xff) << 24);
  };
  const std::uint64_t directory = number(4, 4);
  const std::uint64_t entries = number(directory, 2);
  for (std::uint64_t entry = 0; entry < entries; ++entry) {
    const std::uint64_t place = directory + 2 + entry * entry_bytes;
    if (number(place, 2) != orientation_tag) continue;
    const std::uint64_t orientation = number(place + 8, 2);
    return orientation >= 1 && orientation <= 8 ? static_cast<int>(orientation) : 1;
  }
  return 1;
}

/// Walks the segments up to the picture's data, because an embedded thumbnail has an end of its
/// own.
void look_at_jpeg(Bytes file, PictureFile& seen) {
  seen.jpeg = true;
  bool exif = false;
  std::size_t place = 2;
  while (true) {
    if (place + 4 > file.size()) break;
    if (file[place] != 0xff) return;  // not a well-formed JPEG: the decoder's business
    const std::uint8_t marker = file[place + 1];
    if (marker == 0xff) {  // padding
      ++place;
      continue;
    }
    const auto length = static_cast<std::size_t>(big_endian(file, place + 2, 2));
    if (is_frame(marker)) {
      seen.height = big_endian(file, place + 5, 2);
      seen.width = big_endian(file, place + 7, 2);
      seen.components = static_cast<int>(big_endian(file, place + 9, 1));
    }
    place += 2 + length;
    if (place >= file.size()) break;
    if (marker == 0xe1 && length >= 2 && !exif) {
      const Bytes segment = file.subspan(place - length + 2, length - 2);
      exif = starts_with(segment, exif_start);  // XMP's has the same marker, and may stand before
      if (exif) seen.orientation = orientation_in(segment.subspan(exif_start.size()));
    }
    if (marker != 0xda) continue;  // start of scan
    const Bytes data = file.subspan(place);
    // Searched from behind: some cameras append data of their own.
    if (std::find_end(data.begin(), data.end(), jpeg_end.begin(), jpeg_end.end()) != data.end())
      return;
    break;
  }
  seen.fault = truncated;
}

/// Goes from marker to marker as libjpeg does, over whatever does not belong there: otherwise a
/// byte too many would hide scans.
bool has_too_many_scans(Bytes jpeg) {
  int scans = 0;
  std::size_t place = 0;
  while (true) {
    const Bytes rest = jpeg.subspan(std::min(place, jpeg.size()));
    const auto fill = std::ranges::find(rest, std::uint8_t{0xff});
    if (rest.end() - fill < 2) return false;
    const std::uint8_t marker = fill[1];
    place = jpeg.size() - static_cast<std::size_t>(rest.end() - fill) + (marker == 0xff ? 1 : 2);
    if (marker == 0xd9) return false;  // the picture's end; what follows is the camera's own
    if (marker == 0xda && ++scans > most_scans) return true;
    const bool has_length = marker >= 0xc0 && marker != 0xff && (marker < 0xd0 || marker > 0xd8);
    if (has_length)
      place += static_cast<std::size_t>(std::max<std::uint64_t>(2, big_endian(jpeg, place, 2)));
  }
}

void look_at_png(Bytes file, PictureFile& seen) {
  constexpr std::size_t header_place = png_start.size();  // IHDR: length, type, width, height
  seen.width = big_endian(file, header_place + 8, 4);
  seen.height = big_endian(file, header_place + 12, 4);
  std::uint64_t place = header_place;
  while (place + 12 <= file.size()) {  // a chunk has 12 bytes besides its data
    if (big_endian(file, place + 4, 4) == 0x49454e44) return;  // IEND
    place += 12 + big_endian(file, place, 4);
  }
  seen.fault = truncated;
}

/// The header: width, height and the value of white, with blanks and comments between.
void look_at_pnm(Bytes file, PictureFile& seen) {
  const auto is_digit = [&](std::size_t place) {
    return place < file.size() && file[place] >= '0' && file[place] <= '9';
  };
  std::size_t place = 2;
  for (int number = 0; number < 3; ++number) {
    for (bool comment = false; place < file.size() && (comment || !is_digit(place)); ++place)
      comment = file[place] == '#' || (comment && file[place] != '\n' && file[place] != '\r');
    seen.white = 0;
    for (; is_digit(place); ++place) seen.white = seen.white * 10 + (file[place] - '0');
  }
}

}  // namespace

PictureFile look_at(Bytes file) noexcept {
  PictureFile seen;
  if (file.empty()) seen.fault = "the file is empty";
  if (starts_with(file, jpeg_start)) {
    look_at_jpeg(file, seen);
    if (has_too_many_scans(file)) seen.fault = too_many_scans;
  }
  if (starts_with(file, png_start)) look_at_png(file, seen);
  if (file.size() > 1 && file[0] == 'P' && file[1] >= '2' && file[1] <= '6' && file[1] != '4')
    look_at_pnm(file, seen);
  if (seen.width * seen.height > most_pixels) seen.fault = too_large;
  return seen;
}

}  // namespace seqloop::opencv
