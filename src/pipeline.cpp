// SPDX-License-Identifier: MIT
#include "seqloop/pipeline.hpp"

#include <string>
#include <utility>

namespace seqloop {
namespace {

/// Throws SetupError: with descriptors of another size each frame would be a `frame_error`, and a
/// smaller buffer be written beyond.
std::size_t size_that_fits(const Describer& describer, const Detector& detector,
                           std::size_t descriptor_size) {
  Faults faults;
  if (describer.size() != detector.descriptor_size()) {
    faults.push_back({"describer",
                      "its descriptors have " + std::to_string(describer.size()) +
                          " values, those of the detector's map " +
                          std::to_string(detector.descriptor_size()),
                      "make the map for the describer's size, or take what described the map"});
  }
  if (descriptor_size != describer.size()) {
    faults.push_back({"descriptor_size",
                      std::to_string(descriptor_size) + ", where the describer writes " +
                          std::to_string(describer.size()) + " values",
                      "give the describer's size()"});
  }
  if (!faults.empty()) throw SetupError(std::move(faults));
  return descriptor_size;
}

}  // namespace

Pipeline::Pipeline(FrameSource& source, Describer* describer, Detector& detector, Clock& clock,
                   std::size_t descriptor_size)
    : source_(&source),
      describer_(describer),
      detector_(&detector),
      clock_(&clock),
      descriptor_(describer == nullptr ? 0
                                       : size_that_fits(*describer, detector, descriptor_size)) {}

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
    processed.fault = seen.blank ? "its picture is blank, without any feature"
                      : seen.descriptor.size() != detector_->descriptor_size()
                          ? "its descriptor is of another size than the map's"
                          : "its descriptor is blank, not finite, or not of unit length";
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
