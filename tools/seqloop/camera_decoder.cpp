#include "seqloop/camera_decoder.hpp"

namespace seqloop::program {

namespace {

/// JPEG pictures are decoded at four times the size that is needed, or whole: then a camera sees a
/// place as a recording does. Of 180 answers on Gardens Point (ds 20), as many are others than with
/// whole pictures: 10 at the very size (160x90 instead of 640x360), 8 at twice, 2 at four times the
/// size.
PictureNeeds with_margin(const PictureNeeds& needs) {
  constexpr int margin = 4;
  return {margin * needs.width, margin * needs.height, needs.gray_is_enough};
}

}  // namespace

CameraDecoder::CameraDecoder(const PictureNeeds& needs)
    : raw_(needs.gray_is_enough), mjpg_(with_margin(needs)) {}

std::string_view CameraDecoder::decode(const RawPicture& raw, Image& image) noexcept {
  return raw.format == RawFormat::mjpg ? mjpg_.decode(raw, image) : raw_.decode(raw, image);
}

}  // namespace seqloop::program
