#include "seqloop/source_numbers.hpp"

namespace seqloop::program {

void SourceNumbers::rename(ProcessedFrame& processed) noexcept {
  FrameReport& report = processed.report;
  if (report.gate == Gate::no_frame) return;
  // What the detector has counted in between came just before this frame.
  for (; counted_ <= report.newest; ++counted_) {
    const std::uint64_t number = processed.frame.index - (report.newest - counted_);
    recent_[counted_ % recent_.size()] = number;
    if (counted_ < places_.size()) places_[counted_] = number;
  }
  report.newest = processed.frame.index;
  if (report.frame) report.frame = recent_[*report.frame % recent_.size()];
  if (report.match && !places_.empty()) {
    report.match->place = places_[report.match->place];
    report.match->head = places_[report.match->head];
  }
}

}  // namespace seqloop::program
