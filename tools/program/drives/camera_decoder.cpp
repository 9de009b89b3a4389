// SPDX-License-Identifier: MIT
#include "program/drives/camera_decoder.hpp"

#include "program/options/picture_margin.hpp"

namespace seqloop::program {

CameraDecoder::CameraDecoder(const PictureNeeds& needs)
    : raw_(needs.gray_is_enough), mjpg_(with_margin(needs)) {}

std::string_view CameraDecoder::decode(const RawPicture& raw, Image& image) noexcept {
  return raw.format == RawFormat::mjpg ? mjpg_.decode(raw, image) : raw_.decode(raw, image);
}

}  // namespace seqloop::program
