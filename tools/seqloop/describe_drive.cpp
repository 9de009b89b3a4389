#include "seqloop/describe_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "seqloop/drives.hpp"
#include "seqloop/interruption.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::program {

DescribedCount describe_drive(const std::string& name, FrameSource& source, Describer& describer,
                              files::NpyWriter& out, Progress& progress) {
  DescribedCount count;
  std::vector<float> descriptor(describer.size());
  Frame frame;
  for (Grab grab = source.grab(frame); grab != Grab::end; grab = source.grab(frame)) {
    stop_if_interrupted();
    const DescribedFrame described = describe(grab, frame, &describer, descriptor);
    if (described.descriptor.empty()) {
      std::ranges::fill(descriptor, 0.0F);
      ++count.unreadable;
      progress.tell(fmt::format("{}: frame {}: {}", name, frame.index, described.fault));
    } else if (described.blank) {
      ++count.blank;
    }
    out.append(descriptor);
    progress.step();
  }
  progress.done();
  tell_notes(name, source);
  if (out.rows() == count.unreadable) {
    throw SetupError({name, "none of its frames can be read"});
  }
  out.commit();
  return count;
}

}  // namespace seqloop::program
