// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>

#include "program/map/lasting_map.hpp"
#include "program/run/frame_times.hpp"
#include "program/run/other_loop.hpp"
#include "seqloop/bags/loop_bag.hpp"
#include "seqloop/files/output_file.hpp"
#include "seqloop/frame_report.hpp"

namespace seqloop::program {

/// Writes the accepted answers of a run as a bag of ROS 2.
class ClosuresBag {
 public:
  /// Throws SetupError as files::OutputFile does.
  explicit ClosuresBag(const std::filesystem::path& path);

  /// Adds those that are accepted. @param times of the drive's frames
  /// @param map that places are of; null: none that lasts. Throws files::IoError.
  void add(std::span<const Answer> answers, const FrameTimes& times, const StampAt& stamp_ns,
           const LastingMap* map);

  void add(std::span<const OtherLoop> loops, const FrameTimes& times, const StampAt& stamp_ns);

  /// Throws files::IoError.
  void commit();

 private:
  files::OutputFile out_;
  bags::LoopBag bag_;
};

}  // namespace seqloop::program
