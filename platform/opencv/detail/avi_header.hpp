// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace seqloop::opencv {

constexpr std::size_t avi_chunk_header = 8;  ///< bytes of a chunk's name and size
constexpr std::size_t avi_list_header = 12;  ///< and of a list's own name

/// What an AVI file's headers say of its first video.
struct AviHeader {
  double rate = 0.0;         ///< frames a second; 0: not told
  std::uint64_t frames = 0;  ///< 0: not told
  int stream = 0;            ///< the video's number among the file's streams
  bool motion_jpeg = false;  ///< whether its pictures are JPEG files
  int width = 0;             ///< of motion JPEG, pixels, 1 .. 65,535
  int height = 0;            ///< likewise
};

/// @param head the file's first bytes, as far as its headers reach
/// @return nothing where the file is no AVI file or tells of no video. Allocates: never
[[nodiscard]] std::optional<AviHeader> read_avi_header(std::span<const std::uint8_t> head) noexcept;

}  // namespace seqloop::opencv
