#include "seqloop/map_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "files/descriptor_source.hpp"
#include "seqloop/progress.hpp"

namespace seqloop::program {

std::size_t descriptor_size(const FrameSource& drive, const Describer* describer) {
  const auto* described = dynamic_cast<const files::DescriptorSource*>(&drive);
  return described != nullptr ? described->size() : describer->size();
}

void fill_map(PlaceMap& map, FrameSource& drive, Describer* describer, bool standardise) {
  std::vector<float> descriptor(map.descriptor_size(), 0.0F);
  Progress progress("mapping", drive.frame_count());
  std::size_t readable = 0;
  Frame frame;
  for (Grab grab = drive.grab(frame); grab != Grab::end; grab = drive.grab(frame)) {
    std::string_view fault = frame.fault;
    if (grab == Grab::frame && !frame.descriptor.empty()) {
      std::ranges::copy(frame.descriptor, descriptor.begin());
    } else if (grab == Grab::frame &&
               describer->describe(frame.image, descriptor) == Description::failed) {
      fault = describer->last_fault();
    }
    if (fault.empty()) {
      ++readable;
    } else {
      progress.tell(fmt::format("reference frame {}: {}", frame.index, fault));
    }
    if (!map.add(descriptor)) {
      throw SetupError({"max-places",
                        fmt::format("the reference has more frames than the map has room for, {}",
                                    map.capacity()),
                        "raise --max-places"});
    }
    progress.step();
  }
  progress.done();
  if (readable == 0) throw SetupError(Fault{"reference", "none of its frames can be read"});
  if (standardise) map.standardise();
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw SetupError({folder.string(), "cannot be made: " + error.message()});
}

}  // namespace seqloop::program
