// SPDX-License-Identifier: MIT
#include "experiment/run/matched_run.hpp"

#include <chrono>
#include <span>
#include <utility>
#include <vector>

#include "experiment/run/matrix_recorder.hpp"
#include "program/drives/match_drive.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/process/interruption.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::experiment {
namespace {

double swept(evaluation::ThresholdOn threshold_on, const Answer& answer) {
  switch (threshold_on) {
    case evaluation::ThresholdOn::score:
      return static_cast<double>(answer.match->score);
    case evaluation::ThresholdOn::probability:
      return static_cast<double>(answer.probability);
    case evaluation::ThresholdOn::uniqueness:
      break;
  }
  return static_cast<double>(answer.match->uniqueness);
}

void add(std::vector<evaluation::Answer>& all, std::span<const Answer> answers,
         evaluation::ThresholdOn threshold_on) {
  for (const Answer& answer : answers) {
    if (!answer.match) continue;
    all.push_back({.query = answer.frame,
                   .match = answer.match->frame(),
                   .uncertainty = uncertainty(threshold_on, swept(threshold_on, answer)),
                   .probability = static_cast<double>(answer.probability),
                   .accepted = answer.gate == Gate::match});
  }
}

}  // namespace

MatchedRun match_pair(const RunSpec& run, DescribedPair pair, bool with_matrix) {
  const files::Matrix& query = pair.query;
  MatcherConfig config = run.config;
  suit_slice(config, run.matcher, pair.reference ? pair.reference->rows : query.rows);
  PlaceMap map = program::map_for(config, std::move(pair.reference), query);
  Detector detector(config, map);
  MatrixRecorder recorder(query.rows);
  std::vector<float> column;
  MatchedRun matched;
  std::uint64_t searched = 0;
  for (std::size_t row = 0; row < query.rows; ++row) {
    program::stop_if_interrupted();
    const auto begin = std::chrono::steady_clock::now();
    const FrameReport report = detector.step(query.row(row));
    matched.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    matched.distances += static_cast<double>(report.work.distances);
    matched.most_distances = std::max<std::uint64_t>(matched.most_distances, report.work.distances);
    if (with_matrix) {
      column.resize(map.size());
      detector.newest_column(column);
      column.resize(map.capacity(), -1.0F);
      recorder.add(column);
    }
    if (report.work.candidates > 0) ++searched;
    matched.candidates += static_cast<double>(report.work.candidates);
    add(matched.answers, report.answers, run.threshold_on);
  }
  add(matched.answers, detector.finish(), run.threshold_on);
  matched.distances /= static_cast<double>(query.rows);
  if (searched > 0) matched.candidates /= static_cast<double>(searched);
  if (with_matrix) matched.matrix_png = recorder.png();
  return matched;
}

}  // namespace seqloop::experiment
