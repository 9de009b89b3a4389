// SPDX-License-Identifier: MIT
#include "program/run/source_numbers.hpp"

namespace seqloop::program {
namespace {

/// A number as an index. On 32-bit systems a report's places wrap after 4.5 years at 30 frames/s.
std::size_t at(std::uint64_t number) noexcept { return static_cast<std::size_t>(number); }

}  // namespace

void SourceNumbers::rename(ProcessedFrame& processed) noexcept {
  FrameReport& report = processed.report;
  if (report.gate == Gate::no_frame) return;
  // What the detector has counted in between came just before this frame.
  for (; counted_ <= report.newest; ++counted_) {
    const std::uint64_t number = processed.frame.index - (report.newest - counted_);
    recent_[at(counted_ % recent_.size())] = number;
    if (counted_ < places_.size()) places_[at(counted_)] = number;
  }
  report.newest = processed.frame.index;
  if (report.frame) report.frame = recent_[at(*report.frame % recent_.size())];
  if (report.match && !places_.empty()) {
    report.match->place = at(places_[report.match->place]);
    report.match->head = at(places_[report.match->head]);
  }
}

}  // namespace seqloop::program
