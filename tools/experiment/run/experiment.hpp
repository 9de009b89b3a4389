// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/measures.hpp"
#include "experiment/report/result.hpp"
#include "experiment/run/leave_out.hpp"
#include "program/drives/drives.hpp"
#include "program/drives/stills_source.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/options/truth_settings.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::experiment {

/// `[[drive]]`: where pictures come from. Without a source it has none: all that is known of it has
/// been described elsewhere.
struct DriveSpec {
  std::string name;
  std::string where;  ///< FILE:LINE
  std::filesystem::path source;
  program::StillsSettings stills;
  double fps = 10.0;              ///< of an image folder
  std::vector<Setting> settings;  ///< as written
};

/// `[[descriptor]]`: what describes them, or a folder of what was described elsewhere. One that
/// sets a list of values becomes several.
struct DescriptorSpec {
  std::string name;
  std::string where;
  std::filesystem::path described;  ///< a folder with NAME.npy of each drive; empty: it describes
  program::DriveSettings describer;
  std::vector<std::string> training;  ///< names of drives
  std::vector<Setting> settings;      ///< as written, this one's values
  std::vector<Setting> swept;         ///< those that tell it from its siblings
};

/// `[[pair]]`: two drives along one route, or one that comes back to where it was. Several query
/// drives are matched as one, which goes on from the end of one to the start of the next.
struct PairSpec {
  std::string name;
  std::string where;
  std::string reference;  ///< name of a drive; empty: loops are closed within the query
  std::vector<std::string> queries;
  program::TruthSettings truth;
  std::optional<LeaveOutRule> leave_out;
  std::vector<Setting> settings;  ///< as written
};

/// One method with one set of parameters, one descriptor, one pair: what becomes a `Result`.
struct RunSpec {
  std::string method;
  std::size_t descriptor;  ///< index of it
  std::size_t pair;        ///< likewise
  evaluation::ThresholdOn threshold_on;
  program::MatcherSettings matcher;
  MatcherConfig config;           ///< of these, before the slice is suited to the map
  std::vector<Setting> settings;  ///< as written, those of the descriptor that are swept included
};

/// `best-of` of a method: the best of its results over one setting is shown as one more.
struct BestOf {
  std::string method;
  std::string setting;
};

/// An experiment file.
struct Experiment {
  std::string title;
  std::string text;
  bool timed = false;  ///< match one run at a time, so that none slows another down
  /// Of methods that do not say themselves.
  evaluation::ThresholdOn threshold_on = evaluation::ThresholdOn::uniqueness;
  std::vector<DriveSpec> drives;
  std::vector<DescriptorSpec> descriptors;
  std::vector<PairSpec> pairs;
  std::vector<RunSpec> runs;
  std::vector<BestOf> best_of;
  std::vector<Figure> figures;
  std::vector<Table> tables;
  std::vector<std::filesystem::path> inputs;  ///< files and folders that it names

  /// @return the drive of that name, which must be there
  [[nodiscard]] const DriveSpec& drive(const std::string& name) const;
};

/// Reads an experiment file. Relative paths in it start at `data`; where that is empty, at what the
/// file's own `data` says, itself seen from the file's folder.
/// Adds every fault: unknown keys, drives, descriptors, methods, wrong values. @return what could
/// be read, so that the rest of it can be checked too
[[nodiscard]] Experiment read_experiment(const std::filesystem::path& file,
                                         const std::filesystem::path& data, Faults& faults);

/// The same from text that is at hand. @param file where it came from
[[nodiscard]] Experiment parse_experiment(std::string_view text, const std::filesystem::path& file,
                                          const std::filesystem::path& data, Faults& faults);

}  // namespace seqloop::experiment
