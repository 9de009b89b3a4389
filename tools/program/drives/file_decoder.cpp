// SPDX-License-Identifier: MIT
#include "program/drives/file_decoder.hpp"

#include <memory>

#include "seqloop/turbojpeg/jpeg_file_decoder.hpp"

namespace seqloop::program {

FileDecoder::FileDecoder()
    : raw_(false), files_(false, std::make_unique<turbojpeg::JpegFileDecoder>(false)) {}

std::string_view FileDecoder::decode(const RawPicture& raw, Image& image) noexcept {
  const bool file = raw.format == RawFormat::mjpg || raw.format == RawFormat::png;
  return file ? files_.decode(raw, image) : raw_.decode(raw, image);
}

}  // namespace seqloop::program
