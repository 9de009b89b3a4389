// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/picture_decoder.hpp"

namespace seqloop::opencv {

/// Turns what cameras deliver without compression into grey or BGR pictures; `mjpg` and `png` are
/// refused. Of 16 bits the higher 8 are taken, as OpenCV does with files.
///
/// Grey is Y as the camera sends it: most use 16..235 of the 256 levels, and nothing is stretched,
/// since that changes contrast by one factor everywhere. Colour takes Y, U, V as BT.601 in that
/// limited range, as OpenCV does.
class RawDecoder : public PictureDecoder {
 public:
  /// @param gray make grey pictures; otherwise BGR, and grey only of cameras that see no colour
  explicit RawDecoder(bool gray);
  RawDecoder(const RawDecoder&) = delete;
  RawDecoder& operator=(const RawDecoder&) = delete;
  RawDecoder(RawDecoder&&) = delete;
  RawDecoder& operator=(RawDecoder&&) = delete;
  ~RawDecoder() override;

  /// Looks into the raw picture's memory where that holds what is wanted: the grey plane of GREY,
  /// NV12 and YU12, and BGR3. Everything else is one pass into memory of its own (YU12 in colour:
  /// two), which is taken when the size is new.
  /// Faults: a size of zero or less, rows shorter than the picture is wide, fewer bytes than the
  /// picture has, and in colour an odd size of formats whose pixels share their colour.
  /// Allocates: when the size is new; else never.
  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
