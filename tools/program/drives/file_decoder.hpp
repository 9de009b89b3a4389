// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/opencv/picture_file_decoder.hpp"
#include "seqloop/opencv/raw_decoder.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::program {

/// Decodes whatever a recording holds, raw or as a picture file, whole and in colour: what comes of
/// a file is the same in a bag as in a folder.
class FileDecoder : public PictureDecoder {
 public:
  FileDecoder();

  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override;

 private:
  opencv::RawDecoder raw_;
  opencv::PictureFileDecoder files_;
};

}  // namespace seqloop::program
