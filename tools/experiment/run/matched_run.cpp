// SPDX-License-Identifier: MIT
#include "experiment/run/matched_run.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include "experiment/run/matrix_recorder.hpp"
#include "program/drives/map_builder.hpp"
#include "program/process/interruption.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/files/descriptor_source.hpp"

namespace seqloop::experiment {

MatchedRun match_pair(const MatcherConfig& config, DescribedPair pair,
                      evaluation::ThresholdOn threshold_on, bool with_matrix) {
  const files::Matrix& query = pair.query;
  PlaceMap map(config, {pair.reference ? pair.reference->rows : query.rows, query.columns});
  if (pair.reference) {
    files::DescriptorSource drive(std::move(*pair.reference));
    program::Progress silent;
    fill_map(map, drive, nullptr, config, silent);
  }
  Detector detector(config, map);
  MatrixRecorder recorder(query.rows);
  std::vector<float> column;
  MatchedRun run;
  std::uint64_t searched = 0;
  const bool by_score = threshold_on == evaluation::ThresholdOn::score;
  for (std::size_t row = 0; row < query.rows; ++row) {
    program::stop_if_interrupted();
    const auto begin = std::chrono::steady_clock::now();
    const FrameReport report = detector.step(query.row(row));
    run.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    run.distances += static_cast<double>(report.work.distances);
    run.most_distances = std::max<std::uint64_t>(run.most_distances, report.work.distances);
    if (with_matrix) {
      column.resize(map.size());
      detector.newest_column(column);
      column.resize(map.capacity(), -1.0F);
      recorder.add(column);
    }
    if (report.work.candidates > 0) ++searched;
    run.candidates += static_cast<double>(report.work.candidates);
    if (!report.match) continue;
    const Match& match = *report.match;
    run.answers.push_back({*report.frame, match.place,
                           static_cast<double>(by_score ? match.score : match.uniqueness)});
  }
  run.distances /= static_cast<double>(query.rows);
  if (searched > 0) run.candidates /= static_cast<double>(searched);
  if (with_matrix) run.matrix_png = recorder.png();
  return run;
}

}  // namespace seqloop::experiment
