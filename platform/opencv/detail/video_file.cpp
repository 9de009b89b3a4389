// SPDX-License-Identifier: MIT
#include "opencv/detail/video_file.hpp"

#include <algorithm>

#include "opencv/detail/little_endian.hpp"

namespace seqloop::opencv {

bool tells_frame_rate(Bytes head) noexcept {
  if (has(head, 0, "\xff\xd8\xff")) return false;
  if (!has(head, 0, "RIFF") || !has(head, 8, "AVI ")) return true;
  constexpr std::size_t header = 8;  // of a chunk: name and size
  bool frame_time = false;           // the main header's microseconds a frame
  for (std::size_t place = 12; place + header <= head.size();) {
    if (has(head, place, "LIST")) {  // its chunks are looked at
      place += header + 4;
      continue;
    }
    const std::size_t content = place + header;
    if (has(head, place, "avih")) frame_time = little_endian(head, content) != 0;
    if (has(head, place, "strh") && has(head, content, "vids")) {
      const bool rate =
          little_endian(head, content + 20) != 0 && little_endian(head, content + 24) != 0;
      return rate || frame_time;
    }
    const std::size_t size = little_endian(head, place + 4);
    place = content + std::min(size + size % 2, head.size());
  }
  return true;
}

}  // namespace seqloop::opencv
