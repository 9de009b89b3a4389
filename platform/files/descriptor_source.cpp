// SPDX-License-Identifier: MIT
#include "seqloop/files/descriptor_source.hpp"

#include <cmath>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::files {

DescriptorSource::DescriptorSource(Matrix descriptors, double frames_per_second)
    : descriptors_(std::move(descriptors)), frames_per_second_(frames_per_second) {
  if (!std::isfinite(frames_per_second_) || frames_per_second_ <= 0.0)
    throw SetupError(Fault{"frame rate", "is not a positive number"});
}

Grab DescriptorSource::grab(Frame& frame) noexcept {
  frame = Frame{};
  frame.index = next_;
  frame.time_s = static_cast<double>(next_) / frames_per_second_;
  if (next_ == descriptors_.rows) return Grab::end;
  frame.descriptor = descriptors_.row(next_++);
  return Grab::frame;
}

std::optional<std::uint64_t> DescriptorSource::frame_count() const noexcept {
  return descriptors_.rows;
}

}  // namespace seqloop::files
