// SPDX-License-Identifier: MIT
#include "program/drives/camera_decoder.hpp"

#include "program/options/picture_margin.hpp"

namespace seqloop::program {

CameraDecoder::CameraDecoder(const PictureNeeds& needs, std::string_view size_remedy)
    : raw_(needs.gray_is_enough), mjpg_(with_margin(needs)), size_remedy_(size_remedy) {}

std::string_view CameraDecoder::decode(const RawPicture& raw, Image& image) noexcept {
  if (raw.format != RawFormat::mjpg) return raw_.decode(raw, image);
  const std::string_view fault = mjpg_.decode(raw, image);
  if (size_remedy_.empty() || !mjpg_.is_of_another_size()) return fault;
  fault_.assign({fault, ": ", size_remedy_});
  return fault_.view();
}

}  // namespace seqloop::program
