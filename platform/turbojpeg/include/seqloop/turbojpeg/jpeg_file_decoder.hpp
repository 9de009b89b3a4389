// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "seqloop/fixed_text.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::turbojpeg {

/// Decodes JPEG files whole: the pixels are those of OpenCV where that is built on the same libjpeg
/// (its EXIF orientation apart), in half the time, and damage is found as it is for cameras (see
/// MjpgDecoder). Progressive pictures are taken too.
///
/// Faults are: bytes that are no JPEG picture; four colours; more than 200 million pixels; more
/// than 500 scans; damage; too little memory.
class JpegFileDecoder : public PictureDecoder {
 public:
  /// @param gray decode to grey, which is cheaper; else to B, G, R
  explicit JpegFileDecoder(bool gray) : format_(gray ? PixelFormat::gray8 : PixelFormat::bgr8) {}

  /// @param raw `mjpg`; its width and height are not looked at: the file has its own
  /// @param image its own memory, taken when the size is new
  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override;

 private:
  PixelFormat format_;
  std::vector<std::uint8_t> pixels_;
  FixedText fault_;
};

}  // namespace seqloop::turbojpeg
