#include "seqloop/map_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "files/descriptor_source.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/interruption.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::program {

std::size_t descriptor_size(const FrameSource& drive, const Describer* describer) {
  const auto* described = dynamic_cast<const files::DescriptorSource*>(&drive);
  return described != nullptr ? described->size() : describer->size();
}

void fill_map(PlaceMap& map, FrameSource& drive, Describer* describer, const MatcherConfig& config,
              Progress& progress) {
  std::vector<float> buffer(map.descriptor_size());
  std::vector<float> last(map.descriptor_size(), 0.0F);
  std::size_t readable = 0;
  Frame frame;
  for (Grab grab = drive.grab(frame); grab != Grab::end; grab = drive.grab(frame)) {
    stop_if_interrupted();
    const auto [descriptor, fault, _] = describe(grab, frame, describer, buffer);
    if (descriptor.empty()) {
      progress.tell(fmt::format("reference frame {}: {}", frame.index, fault));
    } else {
      ++readable;
      const bool left_out = config.blank_is_unreadable && blank(config.difference, descriptor);
      if (!left_out) std::ranges::copy(descriptor, last.begin());
    }
    if (!map.add(last)) {
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
