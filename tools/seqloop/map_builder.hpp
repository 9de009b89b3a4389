#pragma once

#include <span>
#include <vector>

#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// Values in a drive's descriptors. @param describer may be null when the drive holds descriptors
[[nodiscard]] std::size_t descriptor_size(const FrameSource& drive, const Describer* describer);

/// Adds places frame by frame. A frame that could not be read gets a place that shows what the
/// frame before it showed, so that places stay in step with frames.
class MapFiller {
 public:
  MapFiller(PlaceMap& map, bool blank_is_unreadable);

  /// @param descriptor [D]; empty: the frame could not be read. @return false when the map is full
  [[nodiscard]] bool add(std::span<const float> descriptor);

 private:
  PlaceMap* map_;
  bool blank_is_unreadable_;
  std::vector<float> last_;
};

/// Makes a map of a whole drive, and tells of frames that cannot be read.
/// Throws SetupError when the map has too little room or no frame can be read.
void fill_map(PlaceMap& map, FrameSource& drive, Describer* describer, const MatcherConfig& config);

}  // namespace seqloop::program
