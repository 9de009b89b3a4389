// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include "program/map/lasting_map.hpp"
#include "program/run/frame_json.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::program {

/// Writes what `run` says, a line a frame.
class FrameLines {
 public:
  using More = std::function<void(nlohmann::ordered_json&)>;

  /// @param out  lives longer
  /// @param live whether each line is written at once. Otherwise it is written when the next one is
  ///   there, so that the last frame's can take the answers that are due at the end.
  /// @param map   what says of which session places are; null: none
  /// @param more  adds to each line what else there is to say of its frame, and to the last what
  ///   is left; empty: nothing
  FrameLines(files::OutputFile& out, bool live, const LastingMap* map, More more)
      : out_(&out), live_(live), map_(map), more_(std::move(more)) {}

  /// Throws files::IoError.
  void add(const ProcessedFrame& processed, const LoopState& state);

  /// Takes the answers that are due at the end: into the last frame's line or, where that is
  /// written, into a line without a frame, of the status `ended`. Throws files::IoError.
  void end(std::span<const Answer> answers);

 private:
  void write();

  files::OutputFile* out_;
  bool live_;
  const LastingMap* map_;
  More more_;
  std::optional<nlohmann::ordered_json> line_;  // that waits to be written
};

}  // namespace seqloop::program
