// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/picture_decoder.hpp"

namespace seqloop::opencv {

/// Decodes the bytes of picture files of every kind that OpenCV reads. Pictures become 8-bit grey
/// or B, G, R: 16-bit ones are scaled, alpha is dropped, and a JPEG is turned as its EXIF
/// orientation says.
class PictureFileDecoder : public PictureDecoder {
 public:
  /// @param gray decode to grey, which is cheaper
  /// @param jpeg decodes JPEG files (`mjpg`), of any size, to grey or colour as `gray` says;
  /// without
  ///   one OpenCV does, which makes up what is damaged and does not tell
  PictureFileDecoder(bool gray, std::unique_ptr<PictureDecoder> jpeg);
  PictureFileDecoder(const PictureFileDecoder&) = delete;
  PictureFileDecoder& operator=(const PictureFileDecoder&) = delete;
  PictureFileDecoder(PictureFileDecoder&&) = delete;
  PictureFileDecoder& operator=(PictureFileDecoder&&) = delete;
  ~PictureFileDecoder() override;

  /// @param raw only its bytes are looked at
  /// Faults: broken, empty or cut off; more than 200 million pixels; too little memory.
  /// Allocates: OpenCV, every picture anew; it also writes to stderr by itself when it meets
  /// damage.
  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
