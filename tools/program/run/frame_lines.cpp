// SPDX-License-Identifier: MIT
#include "program/run/frame_lines.hpp"

#include <utility>

#include "program/process/json_text.hpp"

namespace seqloop::program {

void FrameLines::add(const ProcessedFrame& processed, const LoopState& state) {
  write();
  line_ = frame_json(processed, state);
  if (more_) more_(*line_);
  if (live_) write();
}

void FrameLines::end(std::span<const Answer> answers) {
  if (!line_ && (!answers.empty() || more_)) {
    ProcessedFrame none;
    none.report.gate = Gate::no_frame;
    line_ = frame_json(none, {});
    add_answers(*line_, answers);
    (*line_)["status"] = "ended";
  } else if (line_) {
    add_answers(*line_, answers);
  }
  if (line_ && more_) more_(*line_);
  write();
}

void FrameLines::write() {
  if (!line_) return;
  auto line = std::exchange(line_, std::nullopt);
  if (map_ != nullptr) map_->add_to(*line);
  // A file name in a message may be no UTF-8.
  out_->write(json_text(*line) + '\n');
  out_->flush();
}

}  // namespace seqloop::program
