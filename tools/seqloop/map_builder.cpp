#include "seqloop/map_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "files/descriptor_source.hpp"
#include "seqloop/interruption.hpp"
#include "seqloop/progress.hpp"

namespace seqloop::program {

std::size_t descriptor_size(const FrameSource& drive, const Describer* describer) {
  const auto* described = dynamic_cast<const files::DescriptorSource*>(&drive);
  return described != nullptr ? described->size() : describer->size();
}

namespace {

/// @return the frame's descriptor; empty when it cannot be read or described
std::span<const float> describe(const Frame& frame, Grab grab, Describer* describer,
                                std::span<float> descriptor) {
  if (grab == Grab::unreadable) return {};
  if (!frame.descriptor.empty()) return frame.descriptor;
  const bool failed = describer->describe(frame.image, descriptor) == Description::failed;
  return failed ? std::span<const float>() : descriptor;
}

}  // namespace

MapFiller::MapFiller(PlaceMap& map, bool blank_is_unreadable)
    : map_(&map), blank_is_unreadable_(blank_is_unreadable), last_(map.descriptor_size(), 0.0F) {}

bool MapFiller::add(std::span<const float> descriptor) {
  const bool blank = std::ranges::all_of(descriptor, [](float value) { return value == 0.0F; });
  if (!descriptor.empty() && !(blank && blank_is_unreadable_)) {
    std::ranges::copy(descriptor, last_.begin());
  }
  return map_->add(last_);
}

void fill_map(PlaceMap& map, FrameSource& drive, Describer* describer,
              const MatcherConfig& config) {
  MapFiller filler(map, config.blank_is_unreadable);
  std::vector<float> descriptor(map.descriptor_size());
  Progress progress("mapping", drive.frame_count());
  std::size_t readable = 0;
  Frame frame;
  for (Grab grab = drive.grab(frame); grab != Grab::end; grab = drive.grab(frame)) {
    stop_if_interrupted();
    const std::span<const float> seen = describe(frame, grab, describer, descriptor);
    if (!seen.empty()) {
      ++readable;
    } else {
      progress.tell(fmt::format("reference frame {}: {}", frame.index,
                                grab == Grab::frame ? describer->last_fault() : frame.fault));
    }
    if (!filler.add(seen)) {
      throw SetupError({"max-places",
                        fmt::format("the reference has more frames than the map has room for, {}",
                                    map.capacity()),
                        "raise --max-places"});
    }
    progress.step();
  }
  progress.done();
  if (readable == 0) throw SetupError(Fault{"reference", "none of its frames can be read"});
  if (config.standardisation.on) map.standardise();
}

}  // namespace seqloop::program
