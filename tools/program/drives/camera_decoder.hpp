// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/opencv/raw_decoder.hpp"
#include "seqloop/picture_decoder.hpp"
#include "seqloop/picture_needs.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

namespace seqloop::program {

/// Decodes whatever a camera delivers, no further than a describer needs it.
class CameraDecoder : public PictureDecoder {
 public:
  /// @param needs the describer's
  explicit CameraDecoder(const PictureNeeds& needs);

  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override;

 private:
  opencv::RawDecoder raw_;
  turbojpeg::MjpgDecoder mjpg_;
};

}  // namespace seqloop::program
