// SPDX-License-Identifier: MIT
#include "seqloop/pipeline.hpp"

namespace seqloop {

Pipeline::Pipeline(FrameSource& source, Describer* describer, Detector& detector, Clock& clock,
                   std::size_t descriptor_size)
    : source_(&source),
      describer_(describer),
      detector_(&detector),
      clock_(&clock),
      descriptor_(descriptor_size) {}

std::optional<ProcessedFrame> Pipeline::process() noexcept {
  ProcessedFrame processed;
  const Nanoseconds began = clock_->now();
  const Grab grab = source_->grab(processed.frame);
  if (grab == Grab::end) return std::nullopt;
  if (grab == Grab::silent) {
    processed.report.gate = Gate::no_frame;
    processed.fault = processed.frame.fault;
    return processed;
  }
  const Nanoseconds grabbed = clock_->now();

  const DescribedFrame seen = describe(grab, processed.frame, describer_, descriptor_);
  const Nanoseconds described = clock_->now();
  detector_->skip(processed.frame.lost + processed.frame.dropped);
  processed.report = detector_->step(seen.descriptor);
  const Nanoseconds matched = clock_->now();

  processed.descriptor = seen.descriptor;
  processed.fault = seen.fault;
  if (processed.report.gate == Gate::frame_error && processed.fault.empty()) {
    processed.fault =
        "its descriptor is blank, not finite, not of unit length, or of the wrong size";
  }
  processed.times.age = processed.frame.age;
  processed.times.grab = grabbed - began - processed.frame.waited;
  processed.times.describe = described - grabbed;
  processed.times.match = matched - described;
  processed.times.total = processed.times.grab + (matched - grabbed);
  return processed;
}

DescribedFrame describe(Grab grab, const Frame& frame, Describer* describer,
                        std::span<float> buffer) noexcept {
  if (grab != Grab::frame) return {{}, frame.fault};
  if (!frame.descriptor.empty()) return {frame.descriptor, {}};
  if (describer == nullptr) return {{}, "nothing is there to describe pictures with"};
  const Description description = describer->describe(frame.image, buffer);
  if (description == Description::failed) return {{}, describer->last_fault()};
  return {buffer, {}, description == Description::blank};
}

}  // namespace seqloop
