// SPDX-License-Identifier: MIT
#include "program/run/odometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "evaluation/line_faults.hpp"
#include "files/text_file.hpp"
#include "seqloop/bags/bag.hpp"
#include "seqloop/bags/odometry.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {
namespace {

using Sample = Odometry::Sample;
using Line = std::array<double, 8>;

/// Takes the numbers of a line. @return whether there are eight, and nothing else
bool take_numbers(std::string_view line, Line& numbers) {
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  for (double& number : numbers) {
    at = std::find_if_not(at, end, is_blank);
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc() || !std::isfinite(number)) return false;
    at = next;
  }
  return std::find_if_not(at, end, is_blank) == end;
}

/// Samples whose times rise. Of a stamp that is behind the last one, but not behind the one before,
/// the last was odd. One that is behind both is odd itself, unless the next goes on from it: then
/// the clock was set back.
std::vector<Sample> samples_of(const std::vector<ros::OdometryPose>& poses, std::int64_t start_ns,
                               SetBack behind) {
  std::vector<Sample> samples;
  std::optional<Sample> back;
  for (const ros::OdometryPose& pose : poses) {
    Sample sample{static_cast<double>(pose.stamp_ns - start_ns) * 1e-9,
                  {pose.position, pose.orientation}};
    const bool finite =
        std::ranges::all_of(pose.position, [](double x) { return std::isfinite(x); });
    if (!finite || !make_unit(sample.pose.orientation)) continue;
    const std::optional<Sample> before = std::exchange(back, std::nullopt);
    if (samples.empty() || sample.time_s > samples.back().time_s) {
      samples.push_back(sample);
    } else if (samples.size() == 1 || sample.time_s > samples[samples.size() - 2].time_s) {
      samples.back() = sample;
    } else if (behind == SetBack::begins_anew) {
      if (before && sample.time_s > before->time_s) {
        samples = {*before, sample};
      } else {
        back = sample;
      }
    }
  }
  return samples;
}

/// Refuses what cannot be the drive's.
void check(const Odometry& odometry, const std::string& what) {
  constexpr double day = 86'400.0;
  if (odometry.last_s() >= 0.0 && odometry.first_s() < day) return;
  throw SetupError(
      {"odometry",
       fmt::format(
           "{} begins {:.0f} seconds after the drive and ends {:.0f} seconds after its start", what,
           odometry.first_s(), odometry.last_s()),
       "its times must be those of the drive: a bag's stamps, or seconds from its first frame"});
}

}  // namespace

std::optional<Pose> Odometry::at(double time_s) const noexcept {
  const auto after = std::ranges::lower_bound(samples_, time_s, {}, &Sample::time_s);
  if (after == samples_.end()) return std::nullopt;
  if (after->time_s == time_s) return after->pose;
  if (after == samples_.begin()) return std::nullopt;
  const Sample& before = *(after - 1);
  if (after->time_s - before.time_s > most_gap_s) return std::nullopt;
  return between(before.pose, after->pose,
                 (time_s - before.time_s) / (after->time_s - before.time_s));
}

Odometry parse_tum(const std::string& text, const std::string& name, double start_s) {
  std::vector<Sample> samples;
  evaluation::LineFaults faults(name);
  std::size_t number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string_view line = std::string_view(text).substr(start, end - start);
    start = end + 1;
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#') continue;
    Line values{};
    Sample sample{};
    const bool whole = take_numbers(line, values);
    sample.time_s = values[0] - start_s;
    std::copy_n(values.begin() + 1, 3, sample.pose.position.begin());
    std::copy_n(values.begin() + 4, 4, sample.pose.orientation.begin());
    if (!whole || !make_unit(sample.pose.orientation)) {
      faults.add(
          {name, fmt::format("line {} is no pose", number), "a line is: time x y z qx qy qz qw"});
    } else if (!samples.empty() && sample.time_s <= samples.back().time_s) {
      faults.add({name, fmt::format("line {} is not later than the one before", number)});
    } else {
      samples.push_back(sample);
    }
  }
  faults.refuse();
  if (samples.size() < 2) throw SetupError({name, "holds fewer than two poses"});
  return Odometry(std::move(samples));
}

Odometry odometry_of(const std::vector<ros::OdometryPose>& poses, const std::string& topic,
                     std::int64_t start_ns, SetBack behind) {
  std::vector<Sample> samples = samples_of(poses, start_ns, behind);
  if (samples.size() < 2)
    throw SetupError({"odometry", topic + " holds fewer than two poses whose times rise"});
  const std::size_t left_out = poses.size() - samples.size();
  Odometry odometry(std::move(samples), left_out);
  check(odometry, topic);
  return odometry;
}

Odometry read_odometry(const std::string& what, const std::filesystem::path& source,
                       std::int64_t start_ns) {
  std::error_code error;
  if (what.starts_with('/') && bags::is_bag(source) && !std::filesystem::exists(what, error)) {
    return odometry_of(bags::read_odometry(source, what), what, start_ns, SetBack::left_out);
  }
  Odometry odometry = parse_tum(files::read_text(what), what, static_cast<double>(start_ns) * 1e-9);
  check(odometry, what);
  return odometry;
}

}  // namespace seqloop::program
