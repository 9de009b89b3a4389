// SPDX-License-Identifier: MIT
#include "opencv/detail/avi_header.hpp"

#include <algorithm>
#include <limits>

#include "opencv/detail/little_endian.hpp"

namespace seqloop::opencv {
namespace {

bool is_motion_jpeg(Bytes bytes, std::size_t place) {
  return has(bytes, place, "MJPG") || has(bytes, place, "mjpg");
}

/// From the video's own header. @param frame_time_us of the file's main header; 0: not told
void read_stream(Bytes head, std::size_t content, std::uint32_t frame_time_us, AviHeader& video) {
  const double scale = little_endian(head, content + 20);
  const double rate = little_endian(head, content + 24);
  video.frames = little_endian(head, content + 32);
  if (scale > 0.0 && rate > 0.0)
    video.rate = rate / scale;
  else if (frame_time_us > 0)
    video.rate = 1e6 / frame_time_us;
}

/// From the description of the video's pictures.
void read_format(Bytes head, std::size_t content, AviHeader& video) {
  constexpr std::uint32_t most = std::numeric_limits<std::uint16_t>::max();  // a JPEG's own
  const std::uint32_t width = little_endian(head, content + 4);
  const std::uint32_t height = little_endian(head, content + 8);
  if (!is_motion_jpeg(head, content + 16)) return;
  if (width == 0 || width > most || height == 0 || height > most) return;
  video.motion_jpeg = true;
  video.width = static_cast<int>(width);
  video.height = static_cast<int>(height);
}

}  // namespace

std::optional<AviHeader> read_avi_header(Bytes head) noexcept {
  if (!has(head, 0, "RIFF") || !has(head, 8, "AVI ")) return std::nullopt;
  std::optional<AviHeader> video;
  std::uint32_t frame_time_us = 0;
  int streams = 0;
  for (std::size_t place = avi_list_header; place + avi_list_header <= head.size();) {
    const std::size_t content = place + avi_chunk_header;
    if (has(head, place, "LIST")) {  // its chunks are looked at
      if (has(head, content, "movi")) break;
      place += avi_list_header;
      continue;
    }
    if (has(head, place, "avih")) frame_time_us = little_endian(head, content);
    if (has(head, place, "strh")) {
      if (video) break;  // the next stream's
      if (has(head, content, "vids")) {
        video.emplace().stream = streams;
        read_stream(head, content, frame_time_us, *video);
      }
      ++streams;
    }
    if (video && has(head, place, "strf")) {
      read_format(head, content, *video);
      break;
    }
    const std::size_t size = little_endian(head, place + 4);
    place = content + std::min(size + size % 2, head.size());
  }
  return video;
}

}  // namespace seqloop::opencv
