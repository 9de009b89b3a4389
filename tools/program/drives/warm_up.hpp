// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "seqloop/describer.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::program {

/// Takes describer and matcher through everything that a frame will take them through, so that code
/// is in memory and libraries have made their buffers before the first frame counts. The matcher is
/// a small one of the same configuration; the real one learns nothing of it. Ends early when the
/// program was asked to stop.
/// @param describer null when the drive was described before
void warm_up(Describer* describer, const MatcherConfig& config, std::size_t descriptor_size);

/// Likewise decoder and describer, with pictures of the format and size that a camera will send.
/// @param format as the camera sends it   @param width, height pixels
void warm_up(PictureDecoder& decoder, Describer& describer, RawFormat format, int width,
             int height);

}  // namespace seqloop::program
