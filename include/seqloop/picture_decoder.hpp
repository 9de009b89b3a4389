// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "seqloop/frame.hpp"
#include "seqloop/raw_picture.hpp"

namespace seqloop {

/// Port: turns what a camera delivers into a picture that describers take.
class PictureDecoder {
 public:
  PictureDecoder() = default;
  PictureDecoder(const PictureDecoder&) = delete;
  PictureDecoder& operator=(const PictureDecoder&) = delete;
  PictureDecoder(PictureDecoder&&) = delete;
  PictureDecoder& operator=(PictureDecoder&&) = delete;
  virtual ~PictureDecoder() = default;

  /// @param image written: grey or BGR, whichever the decoder was made for; it may look into the
  ///   raw picture's own memory. Valid until the next call and as long as `raw`
  /// @return why the picture cannot be decoded, valid until the next call; empty when it can
  /// Errors: none thrown. Allocates: for raw formats nothing once the size has been seen.
  [[nodiscard]] virtual std::string_view decode(const RawPicture& raw, Image& image) noexcept = 0;
};

}  // namespace seqloop
