// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "program/process/attempts.hpp"
#include "program/run/odometry.hpp"
#include "program/run/pose.hpp"
#include "seqloop/files/output_file.hpp"
#include "seqloop/frame_report.hpp"

namespace seqloop::program {

/// Collects a drive's poses by odometry and its accepted loops, and writes them for an optimiser.
///
/// What an edge's information matrix means is on the program's page, "Pose graph".
class PoseGraph {
 public:
  /// How far a right answer is off, in frames.
  static constexpr std::uint64_t loop_frames = 2;

  /// @param file g2o, opened at once; empty: not wanted   @param trajectory TUM, likewise
  /// Throws SetupError as files::OutputFile does.
  PoseGraph(const std::filesystem::path& file, const std::filesystem::path& trajectory);

  /// @param start_s    what the odometry's clock said at the drive's second 0
  /// @param sequence   frames that share one window: ds + 1
  void begin(Odometry odometry, double start_s, std::size_t sequence);

  /// @param frame higher than all before. One outside of the odometry's times is no vertex.
  void add(std::uint64_t frame, double time_s);

  /// Takes those that are accepted and close a loop.
  void add(std::span<const Answer> answers);

  /// What a person should know, one line each; complete before `commit`.
  [[nodiscard]] std::vector<std::string> notes() const;

  /// Writes each of the files that are wanted. Fails where no frame has a pose.
  void commit(Attempts& attempt);

 private:
  struct Vertex {
    std::uint64_t frame;
    double time_s;
    Pose pose;
  };
  struct Loop {
    std::uint64_t frame;
    std::uint64_t match;
    double probability;
  };

  [[nodiscard]] bool has_poses(const Loop& loop) const noexcept;
  [[nodiscard]] const Vertex* vertex(std::uint64_t frame) const noexcept;
  [[nodiscard]] double metres_a_frame() const;
  void write_graph();
  void write_trajectory();

  std::unique_ptr<files::OutputFile> graph_;
  std::unique_ptr<files::OutputFile> trajectory_;
  std::optional<Odometry> odometry_;
  double start_s_ = 0.0;
  std::size_t sequence_ = 1;
  std::vector<Vertex> vertices_;
  std::vector<Loop> loops_;
  std::uint64_t without_pose_ = 0;  // frames outside of the odometry's times
  std::uint64_t in_gaps_ = 0;       // frames in its gaps
};

}  // namespace seqloop::program
