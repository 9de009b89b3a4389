// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "seqloop/fixed_text.hpp"
#include "seqloop/opencv/raw_decoder.hpp"
#include "seqloop/picture_decoder.hpp"
#include "seqloop/picture_needs.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

namespace seqloop::program {

/// Decodes whatever a camera delivers, no further than a describer needs it.
class CameraDecoder : public PictureDecoder {
 public:
  /// @param needs the describer's
  /// @param size_remedy what to do where JPEG pictures are of another size than was declared
  explicit CameraDecoder(const PictureNeeds& needs, std::string_view size_remedy = {});

  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override;

 private:
  opencv::RawDecoder raw_;
  turbojpeg::MjpgDecoder mjpg_;
  std::string size_remedy_;
  FixedText fault_;
};

}  // namespace seqloop::program
