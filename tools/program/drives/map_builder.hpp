// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "program/process/progress.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// Values in a drive's descriptors. @param describer may be null when the drive holds descriptors
[[nodiscard]] std::size_t descriptor_size(const FrameSource& drive, const Describer* describer);

/// What a map was made of.
struct Mapped {
  std::size_t frames;
  std::size_t blank;  ///< of them, without any feature
};

/// Makes a map of a whole drive. A frame that cannot be read is told of, and its place shows what
/// the frame before it showed, so that places stay in step with frames. Where places are
/// standardised, and nothing is known of descriptors of this kind, they are held as float until all
/// have been seen. Of a map by probability the places that are visits of one place are linked, of
/// the first 20,000.
/// @param look at each frame that can be read; may be empty
/// Throws SetupError when the map has too little room or no frame can be read.
Mapped fill_map(PlaceMap& map, FrameSource& drive, Describer* describer,
                const MatcherConfig& config, Progress& progress,
                const std::function<void(const Frame&)>& look = {});

}  // namespace seqloop::program
