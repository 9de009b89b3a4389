// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <span>
#include <vector>

#include "platform/pictures.hpp"
#include "seqloop/raw_picture.hpp"

namespace seqloop::test {

using Bytes = std::vector<std::uint8_t>;

/// @param parameters of OpenCV's encoder; without any, the standard's Huffman tables are used
inline Bytes jpeg_of(const cv::Mat& picture, const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(".jpg", picture, bytes, parameters);
  return bytes;
}

/// Where the first segment with the marker begins, or the size.
inline std::size_t segment(const Bytes& jpeg, std::uint8_t marker) {
  std::size_t place = 2;
  while (place + 4 <= jpeg.size() && jpeg[place + 1] != marker && jpeg[place + 1] != 0xda)
    place += 2 + static_cast<std::size_t>(jpeg[place + 2] << 8 | jpeg[place + 3]);
  return place + 4 <= jpeg.size() && jpeg[place + 1] == marker ? place : jpeg.size();
}

inline std::size_t segment_end(const Bytes& jpeg, std::size_t place) {
  return place + 2 + static_cast<std::size_t>(jpeg[place + 2] << 8 | jpeg[place + 3]);
}

/// The picture's first byte of data.
inline std::size_t data_begin(const Bytes& jpeg) { return segment_end(jpeg, segment(jpeg, 0xda)); }

/// With numbers that decoders make no use of and libjpeg warns of: JFIF's revision, and where the
/// scan's spectrum ends.
inline Bytes with_odd_header(Bytes jpeg) {
  jpeg.at(segment(jpeg, 0xe0) + 9) = 9;
  jpeg.at(data_begin(jpeg) - 2) = 0;
  return jpeg;
}

/// As cameras send it: without Huffman tables.
inline Bytes without_tables(Bytes jpeg) {
  for (std::size_t at = segment(jpeg, 0xc4); at < jpeg.size(); at = segment(jpeg, 0xc4)) {
    const auto begin = jpeg.begin();
    jpeg.erase(begin + static_cast<std::ptrdiff_t>(at),
               begin + static_cast<std::ptrdiff_t>(segment_end(jpeg, at)));
  }
  return jpeg;
}

inline RawPicture mjpg(std::span<const std::uint8_t> bytes, int width, int height) {
  return {.bytes = bytes, .width = width, .height = height, .stride = 0, .format = RawFormat::mjpg};
}

}  // namespace seqloop::test
