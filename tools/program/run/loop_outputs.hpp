// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "program/options/options.hpp"
#include "program/run/closures_bag.hpp"
#include "program/run/frame_times.hpp"
#include "program/run/pose_graph.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::program {

/// What else is made of accepted answers, as a user asks for it.
struct LoopOutputSettings {
  std::filesystem::path bag;
  std::string odometry;  ///< a file of poses, or a topic of the drive's bag
  std::filesystem::path pose_graph;
  std::filesystem::path trajectory;
};

/// Flags `--out-bag`, `--odometry`, `--pose-graph`, `--trajectory`.
/// @param settings lives as long as the table
void add_loop_output_options(OptionTable& options, LoopOutputSettings& settings);

/// Takes a run's accepted answers, and writes what is made of them. Nothing, unless asked for.
class LoopOutputs {
 public:
  /// Opens the files. Adds faults where it cannot.
  /// @param own_places whether places are frames of the drive itself
  LoopOutputs(const LoopOutputSettings& settings, bool own_places, Faults& faults);

  /// Reads the odometry. @param recording null: a camera   @param sequence ds + 1
  /// Throws SetupError.
  void begin(const LoopOutputSettings& settings, const std::filesystem::path& source,
             const FrameSource* recording, std::size_t sequence);

  /// Throw files::IoError.
  void add(const ProcessedFrame& processed);
  void add(std::span<const Answer> answers);
  void commit();

  /// What a person should know, one line each; complete before `commit`.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  bool own_places_;
  FrameTimes times_;
  std::unique_ptr<ClosuresBag> bag_;
  std::unique_ptr<PoseGraph> graph_;
};

}  // namespace seqloop::program
