// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "program/run/pose.hpp"
#include "seqloop/ros/odometry.hpp"

namespace seqloop::program {

/// Where the robot believed to be, over time.
class Odometry {
 public:
  struct Sample {
    double time_s;  ///< since the drive's second 0
    Pose pose;
  };

  /// How far two samples may be apart: nobody knows how the robot drove in between.
  static constexpr double most_gap_s = 10.0;

  /// @param samples with times that rise; at least two
  /// @param left_out samples that there were besides
  explicit Odometry(std::vector<Sample> samples, std::size_t left_out = 0)
      : samples_(std::move(samples)), left_out_(left_out) {}

  /// @return between the two samples around a time; nothing before the first and after the last,
  ///   and where they are too far apart
  [[nodiscard]] std::optional<Pose> at(double time_s) const noexcept;

  [[nodiscard]] double first_s() const noexcept { return samples_.front().time_s; }
  [[nodiscard]] double last_s() const noexcept { return samples_.back().time_s; }
  [[nodiscard]] std::size_t left_out() const noexcept { return left_out_; }

 private:
  std::vector<Sample> samples_;
  std::size_t left_out_;
};

/// Takes lines `time x y z qx qy qz qw` (TUM); `#` begins a comment.
/// @param start_s what the file's clock said at the drive's second 0
/// Throws SetupError: a line that is none, times that do not rise, fewer than two.
[[nodiscard]] Odometry parse_tum(const std::string& text, const std::string& name, double start_s);

/// What becomes of poses behind a clock that is set back. The times of a live drive's frames follow
/// the clock, those of a recording never go back.
enum class SetBack : std::uint8_t {
  left_out,    ///< until the clock is where it was
  begins_anew  ///< those before it are left out
};

/// What a topic said. A single stamp that is odd costs its own pose.
/// @param poses in the order in which they came   @param start_ns when the drive's second 0 was
/// Throws SetupError: fewer than two poses whose times rise, or the times of another clock.
[[nodiscard]] Odometry odometry_of(const std::vector<ros::OdometryPose>& poses,
                                   const std::string& topic, std::int64_t start_ns, SetBack behind);

/// Reads a topic of the drive's own bag, or a file. @param what names one or the other
/// @param source the drive   @param start_ns when its second 0 was; 0: a file counts from there
/// Throws SetupError; also where the times are those of another clock.
[[nodiscard]] Odometry read_odometry(const std::string& what, const std::filesystem::path& source,
                                     std::int64_t start_ns);

}  // namespace seqloop::program
