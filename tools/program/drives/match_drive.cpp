// SPDX-License-Identifier: MIT
#include "program/drives/match_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "program/drives/drive_length.hpp"
#include "program/drives/map_builder.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/files/descriptor_source.hpp"
#include "seqloop/opencv/builtin_describer.hpp"

namespace seqloop::program {
namespace {

/// The answers of a recording.
class MatchList {
 public:
  /// @param frames of the recording
  MatchList(const MatcherConfig& config, std::size_t frames)
      : after_centre_(config.sequence_length - config.sequence_length / 2), searched_(frames) {}

  void add(const FrameReport& report) {
    add(report.answers);
    if (report.newest < after_centre_) return;
    MatchedFrame& centre = searched_[static_cast<std::size_t>(report.newest - after_centre_)];
    centre.candidates = report.work.candidates;
    centre.k = report.k;
    centre.distances = report.work.distances;
  }

  void add(std::span<const Answer> answers) {
    for (const Answer& answer : answers) {
      searched_[static_cast<std::size_t>(answer.frame)].answer = answer;
    }
  }

  [[nodiscard]] std::vector<MatchedFrame> take() {
    std::erase_if(searched_, [](const MatchedFrame& frame) { return !frame.answer.match; });
    return std::move(searched_);
  }

 private:
  std::size_t after_centre_;
  std::vector<MatchedFrame> searched_;  // by frame
};

}  // namespace

std::size_t MatchedDrive::accepted() const noexcept {
  return static_cast<std::size_t>(std::ranges::count(
      frames, Gate::match, [](const MatchedFrame& frame) { return frame.answer.gate; }));
}

void check_match(Faults& faults, const MatcherConfig& config, const files::Matrix* reference,
                 const files::Matrix& query) {
  if (reference != nullptr && query.columns != reference->columns) {
    faults.push_back({"reference, query",
                      fmt::format("{} in a row of one, {} in a row of the other",
                                  counted(reference->columns, "value"), query.columns),
                      "describe both with the same model and layer"});
  }
  if (validate(config).empty()) {
    check_length(faults, config, query.rows, reference != nullptr ? reference->rows : query.rows);
  }
}

MatchedDrive match_frames(Detector& detector, const MatcherConfig& config,
                          const files::Matrix& query, const MatchWatch& watch) {
  MatchedDrive matched;
  MatchList list(config, query.rows);
  std::vector<std::span<const float>> frames;
  std::vector<FrameReport> reports(config.frames_at_once);
  for (std::size_t row = 0; row < query.rows; row += frames.size()) {
    if (watch.between) watch.between();
    frames.clear();
    const std::size_t last = std::min(row + config.frames_at_once, query.rows);
    for (std::size_t next = row; next < last; ++next) {
      frames.push_back(query.row(next));
      if (blank(config.difference, frames.back())) ++matched.blank_frames;
    }
    const std::size_t taken = detector.steps(frames, reports);
    for (const FrameReport& report : std::span(reports).first(taken)) {
      if (watch.progress != nullptr) watch.progress->step();
      list.add(report);
      if (watch.report) watch.report(report);
    }
  }
  const std::span<const Answer> rest = detector.finish();
  list.add(rest);
  if (watch.rest) watch.rest(rest);
  if (watch.progress != nullptr) watch.progress->done();
  matched.frames = list.take();
  return matched;
}

PlaceMap map_for(const MatcherConfig& config, std::optional<files::Matrix> reference,
                 const files::Matrix& query, const std::function<void()>& between) {
  PlaceMap map(config, {reference ? reference->rows : query.rows, query.columns});
  opencv::expect_builtin(map);
  if (reference) {
    files::DescriptorSource drive(std::move(*reference));
    Progress silent;
    const auto look = [&between](const Frame& frame) {
      if (between && frame.index % MatcherConfig::most_frames_at_once == 0) between();
    };
    (void)fill_map(map, drive, nullptr, config, silent, look);
  }
  return map;
}

MatchedDrive match_drive(MatcherConfig config, std::optional<files::Matrix> reference,
                         const files::Matrix& query, const MatchWatch& watch) {
  // A recording is there whole, so that places can be read once for many frames.
  config.frames_at_once = MatcherConfig::most_frames_at_once;
  PlaceMap map = map_for(config, std::move(reference), query, watch.between);
  Detector detector(config, map);
  return match_frames(detector, config, query, watch);
}

}  // namespace seqloop::program
