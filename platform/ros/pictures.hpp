// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "seqloop/fixed_text.hpp"
#include "seqloop/raw_picture.hpp"

namespace seqloop::ros {

enum class PictureType : std::uint8_t {
  none,       ///< the type is no picture
  image,      ///< sensor_msgs/msg/Image
  compressed  ///< sensor_msgs/msg/CompressedImage
};

/// @param type as bags name it, `sensor_msgs/msg/Image`; old ones leave `msg` out
[[nodiscard]] PictureType picture_type(std::string_view type) noexcept;

/// A picture in a message's own memory.
struct PictureMessage {
  std::int64_t stamp_ns = 0;  ///< when it was taken, since 1970; 0 where nobody said
  RawPicture picture;
};

/// Reads `Image` (mono8, rgb8, bgr8, rgba8, bgra8, mono16, both orders of YUV 4:2:2, and OpenCV's
/// 8UC1, 8UC3 and 16UC1) or `CompressedImage` (JPEG, PNG).
/// @param fault set to why it cannot be read, or emptied. The decoder finds sizes that do not fit
/// @return also where there is a fault: the stamp, as far as that could be read
/// Allocates: never.
[[nodiscard]] PictureMessage read_picture(PictureType type, std::span<const std::uint8_t> message,
                                          FixedText& fault) noexcept;

}  // namespace seqloop::ros
