// SPDX-License-Identifier: MIT
#include "program/verbs/camera_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "program/process/milliseconds.hpp"
#include "seqloop/linux/pixel_format.hpp"

namespace seqloop::program {
namespace {

std::string percentiles(const LatencyHistogram& times) {
  return fmt::format("p50 {:.2f} ms, p99 {:.2f} ms, max {:.2f} ms",
                     milliseconds(times.quantile(0.5)), milliseconds(times.quantile(0.99)),
                     milliseconds(times.maximum()));
}

/// `  YUYV  640x480   30 25 10 fps`, a line a size.
std::string mode_lines(const live::CameraOffer& offer) {
  std::vector<std::pair<std::string, std::vector<double>>> sizes;
  for (const live::CameraMode& mode : offer.modes) {
    const std::string size = fmt::format("{:<6}{:<11}", live::fourcc_text(mode.fourcc),
                                         fmt::format("{}x{}", mode.width, mode.height));
    if (sizes.empty() || sizes.back().first != size) sizes.emplace_back(size, 0);
    if (live::rate(mode) > 0.0) sizes.back().second.push_back(live::rate(mode));
  }
  std::string lines;
  for (const auto& [size, rates] : sizes) {
    lines += rates.empty() ? fmt::format("    {}rate not told\n", size)
                           : fmt::format("    {}{:.4g} fps\n", size, fmt::join(rates, " "));
  }
  return lines;
}

std::string control_line(const live::CameraControl& control) {
  std::string line = fmt::format("    {:<34}{:<8}{} .. {}", control.name, control.type,
                                 control.minimum, control.maximum);
  if (control.step > 1) line += fmt::format(" step {}", control.step);
  line += fmt::format(", default {}", control.preset);
  if (control.readable) line += fmt::format(", now {}", control.value);
  if (!control.items.empty()) line += fmt::format(" ({})", fmt::join(control.items, ", "));
  return line + '\n';
}

}  // namespace

std::string describe_camera(const live::ListedCamera& camera) {
  if (!camera.fault.empty()) return camera.fault + '\n';
  const live::CameraIdentity& identity = camera.identity;
  std::string text =
      fmt::format("{}: {} (driver {}, {}{})\n", camera.path, identity.card, identity.driver,
                  identity.bus, identity.serial.empty() ? "" : ", serial " + identity.serial);
  for (const std::string& link : camera.links) text += fmt::format("  also {}\n", link);
  text += "  formats\n" + mode_lines(camera.offer);
  for (const std::string& range : camera.offer.ranges) text += fmt::format("    {}\n", range);
  if (!camera.offer.other_formats.empty()) {
    text += fmt::format("    not readable here: {}\n", fmt::join(camera.offer.other_formats, ", "));
  }
  if (camera.offer.modes.empty()) text += "    none that can be read here\n";
  if (!camera.controls.empty()) text += "  controls\n";
  for (const live::CameraControl& control : camera.controls) text += control_line(control);
  return text;
}

void FrameTimes::add(const Captured& captured) {
  const bool follows = seen_ && captured.index == last_index_ + 1;
  if (seen_ && !follows) ++gaps_;
  seen_ = true;
  last_index_ = captured.index;
  const bool after_a_good_one = std::exchange(last_was_good_, captured.what == Capture::frame);
  if (!last_was_good_) return;
  if (frames_++ == 0) first_stamp_ = captured.stamp;
  if (follows && after_a_good_one) intervals_.push_back(captured.stamp - last_stamp_);
  ages_.add(captured.arrived - captured.stamp);
  last_stamp_ = captured.stamp;
}

std::string FrameTimes::report(const live::CameraOptions& asked, const live::CameraFacts& facts,
                               const live::CameraCounters& counters) const {
  std::string text = fmt::format("{}: {} (driver {}, {})\n", facts.path, facts.identity.card,
                                 facts.identity.driver, facts.identity.bus);
  const auto line = [&text](std::string_view what, std::string_view value) {
    text += fmt::format("  {:<11}{}\n", what, value);
  };
  const live::CameraMode& mode = facts.mode;
  line("mode",
       fmt::format("{}{}, for {:.4g} fps or more", live::to_string(mode),
                   live::rate(mode) > 0.0 ? "" : " at a rate that is not told", asked.wish.rate));
  line("buffers",
       fmt::format("{}{}", facts.buffers, facts.copies ? ", so few that pictures are copied" : ""));
  const double seconds = milliseconds(last_stamp_ - first_stamp_) / 1e3;
  line("frames", seconds > 0.0 ? fmt::format("{} in {:.2f} s: {:.2f} fps", frames_, seconds,
                                             static_cast<double>(frames_ - 1) / seconds)
                               : fmt::format("{}", frames_));
  line("missed", fmt::format("{} in {} gaps", counters.missed, gaps_));
  line("errors", fmt::format("{} damaged frames, {} times silent, {} restarts of the stream, "
                             "{} reopenings, {} losses of the device",
                             counters.bad, counters.silences, counters.restarts,
                             counters.reopenings, counters.losses));
  if (!intervals_.empty()) {
    const Nanoseconds sum = std::accumulate(intervals_.begin(), intervals_.end(), Nanoseconds(0));
    const Nanoseconds mean = sum / static_cast<std::int64_t>(intervals_.size());
    LatencyHistogram deviations;
    for (const Nanoseconds interval : intervals_) {
      deviations.add(std::chrono::abs(interval - mean));
    }
    line("interval",
         fmt::format("mean {:.3f} ms; off by {}", milliseconds(mean), percentiles(deviations)));
  }
  if (frames_ > 0) line("age", fmt::format("when taken up: {}", percentiles(ages_)));
  for (std::size_t kind = 1; kind < live::odd_stamp_kinds; ++kind) {
    if (counters.odd_stamps[kind] == 0) continue;
    line("stamps", fmt::format("{} times {}", counters.odd_stamps[kind],
                               live::to_string(static_cast<live::OddStamp>(kind))));
  }
  return text;
}

}  // namespace seqloop::program
