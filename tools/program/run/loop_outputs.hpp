// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "program/map/lasting_map.hpp"
#include "program/options/options.hpp"
#include "program/process/attempts.hpp"
#include "program/run/closures_bag.hpp"
#include "program/run/frame_times.hpp"
#include "program/run/other_loop.hpp"
#include "program/run/pose_graph.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/pipeline.hpp"
#include "seqloop/ros/odometry.hpp"

namespace seqloop::program {

/// What else is made of accepted answers, as a user asks for it.
struct LoopOutputSettings {
  std::filesystem::path bag;
  std::string odometry;  ///< a file of poses, or a topic of the drive's bag
  std::filesystem::path pose_graph;
  std::filesystem::path trajectory;
};

/// Whether `--odometry` names a topic of ROS 2 that is to be listened to.
/// @param live whether the drive comes from a camera or a topic
[[nodiscard]] bool listens_to_odometry(const LoopOutputSettings& settings, bool live);

/// Flags `--out-bag`, `--odometry`, `--pose-graph`, `--trajectory`.
/// @param settings lives as long as the table
void add_loop_output_options(OptionTable& options, LoopOutputSettings& settings);

/// What the outputs must know of a drive.
struct LoopDrive {
  std::filesystem::path source = {};
  const FrameSource* recording = nullptr;       ///< null: it comes live
  std::function<std::int64_t()> start_ns = {};  ///< as RunSetup's
  StampAt stamp_ns = {};
  std::size_t sequence = 1;  ///< frames of a window: ds + 1
  /// Of a live drive: the odometry that has come; none where none is asked for.
  std::function<std::vector<ros::OdometryPose>()> odometry = {};
  const LastingMap* map = nullptr;  ///< that places are of; null: none that lasts
};

/// Takes a run's accepted answers, and writes what is made of them. Nothing, unless asked for.
class LoopOutputs {
 public:
  /// Opens the files. Adds faults where it cannot.
  /// @param closing whether frames of the drive are places, beside those of a map that lasts
  LoopOutputs(const LoopOutputSettings& settings, bool closing, Faults& faults);

  /// Reads the odometry of a recording. Throws SetupError.
  void begin(const LoopOutputSettings& settings, LoopDrive drive);

  /// Throw files::IoError; the others go on without the output that failed.
  /// @param place the number that the newest frame has as a place; nothing where it is none
  void add(const ProcessedFrame& processed, std::optional<std::uint64_t> place);
  void add(std::span<const Answer> answers);
  void add(std::span<const OtherLoop> loops);

  /// All answers are there: takes the odometry that has come meanwhile. Throws SetupError, and goes
  /// on without a pose graph.
  void end();

  /// Completes each of the outputs that have not failed.
  void commit(Attempts& attempt);

  /// What a person should know, one line each; complete after `end`.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  void add_to_graph(std::span<const Answer> answers);

  LoopDrive drive_;
  std::string topic_;             // of odometry that comes while the drive goes on
  std::vector<Answer> loops_;     // within the drive, by its frames' numbers
  std::uint64_t of_earlier_ = 0;  // loops with places of earlier sessions
  std::uint64_t of_others_ = 0;   // of other robots
  std::uint64_t of_unseen_ = 0;   // of frames of the drive that never came
  FrameTimes times_;
  std::unique_ptr<ClosuresBag> bag_;
  std::unique_ptr<PoseGraph> graph_;
};

}  // namespace seqloop::program
