// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "program/run/frame_json.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::program {

/// Writes what `run` says, a line a frame.
class FrameLines {
 public:
  /// @param out  lives longer
  /// @param live whether each line is written at once. Otherwise it is written when the next one is
  ///   there, so that the last frame's can take the answers that are due at the end.
  FrameLines(files::OutputFile& out, bool live) : out_(&out), live_(live) {}

  /// Throws files::IoError.
  void add(const ProcessedFrame& processed, const LoopState& state);

  /// Takes the answers that are due at the end: into the last frame's line or, where that is
  /// written, into a line without a frame, of the status `ended`. Throws files::IoError.
  void end(std::span<const Answer> answers);

 private:
  void write();

  files::OutputFile* out_;
  bool live_;
  std::optional<nlohmann::ordered_json> line_;  // that waits to be written
};

}  // namespace seqloop::program
