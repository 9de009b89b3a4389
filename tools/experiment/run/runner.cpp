// SPDX-License-Identifier: MIT
#include "experiment/run/runner.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <set>
#include <tuple>

#include "experiment/report/report.hpp"
#include "experiment/report/selection.hpp"
#include "experiment/run/described_drives.hpp"
#include "experiment/run/experiment.hpp"
#include "experiment/run/fingerprint.hpp"
#include "experiment/run/kept_result.hpp"
#include "experiment/run/matched_run.hpp"
#include "experiment/run/pair_truth.hpp"
#include "experiment/run/summary.hpp"
#include "files/text_file.hpp"
#include "program/drives/drive_length.hpp"
#include "program/options/flag_names.hpp"
#include "program/options/model_options.hpp"
#include "program/options/verb.hpp"
#include "program/process/build_info.hpp"
#include "program/process/outputs.hpp"
#include "program/process/say.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/files/output_file.hpp"
#include "seqloop/opencv/threads.hpp"

namespace seqloop::experiment {
namespace {

/// Whether a folder is new, empty, or an experiment's already.
bool may_be_filled(const std::filesystem::path& folder) {
  const auto page = folder / "index.html";
  std::error_code error;
  if (std::filesystem::exists(page, error)) return is_report(page);
  const auto has = [&](const char* name) { return std::filesystem::exists(folder / name, error); };
  if (has("descriptors") && has("runs")) return true;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto name = entry->path().filename();
    if (name != "descriptors" && name != "runs") return false;
  }
  return true;
}

class Runner {
 public:
  Runner(const Experiment& experiment, std::filesystem::path folder)
      : experiment_(experiment),
        folder_(std::move(folder)),
        drives_(experiment, folder_ / "descriptors"),
        kept_frames_(experiment.pairs.size()) {}

  /// Adds everything that is wrong, before any work.
  void check(Faults& faults) {
    if (!folder_.empty()) check_folder(faults);
    drives_.check(faults);
    for (std::size_t pair = 0; pair < experiment_.pairs.size(); ++pair) {
      const PairSpec& spec = experiment_.pairs[pair];
      check_lengths(pair,
                    lengths_of(spec, [this](const auto& name) { return drives_.length(name); }),
                    faults);
    }
  }

  void run(std::size_t threads) {
    for (const char* kept : {"descriptors", "runs"}) {
      program::make_folder(folder_ / kept);
      files::remove_abandoned(folder_ / kept);
    }
    std::vector<Job> first = drives_.jobs();
    for (Job& job : leave_out_jobs()) first.push_back(std::move(job));
    do_jobs("preparing", first, threads);
    alone_ = experiment_.timed || threads == 1;
    do_jobs("matching", match_jobs(), alone_ ? 1 : threads);
  }

  [[nodiscard]] Report report() const {
    Report report{experiment_.title,   experiment_.text,   {}, {},
                  experiment_.figures, experiment_.tables, {}};
    for (const RunSpec& run : experiment_.runs) {
      report.results.push_back(kept_result(file(run, "json")).value());
      if (!shown_as_matrix(run)) continue;
      const std::string png = kept_picture(run, report.results.back()).value();
      report.matrices.push_back({fmt::format("{}: {}", report.results.back().pair, run.method),
                                 report.results.back().descriptor,
                                 {png.begin(), png.end()}});
    }
    report.conditions = conditions(report.results);
    for (const PairSpec& pair : experiment_.pairs) {
      report.pairs.push_back({pair.name, how_judged(pair)});
    }
    add_speed_ups(experiment_, report.results);
    add_best(experiment_, report.results);
    return report;
  }

 private:
  /// Nothing that is read and nothing of anybody else's may be written over.
  void check_folder(Faults& faults) const {
    program::check_folder(faults, folder_);
    std::vector<program::FileUse> uses;
    const auto add = [&uses](const char* flag, program::Access access, const auto& path) {
      uses.push_back({flag, access, path});
    };
    for (const auto& input : experiment_.inputs) add("experiment", program::Access::reads, input);
    for (const DescriptorSpec& descriptor : experiment_.descriptors) {
      Faults told_later;
      program::collect(told_later, [&] {
        for (const auto& file : program::model_files(descriptor.describer.model,
                                                     descriptor.describer.model_flags_given)) {
          add("experiment", program::Access::reads, file);
        }
      });
    }
    add("out", program::Access::fills, folder_);
    for (const char* name : {"index.html", "results.csv"}) {
      add("out", program::Access::writes, folder_ / name);
    }
    program::refuse_overwriting(faults, uses);
    if (!may_be_filled(folder_)) {
      faults.push_back({"out", folder_.string() + " holds something that no experiment has left",
                        "choose a new folder, or an empty one"});
    }
  }

  /// @param length_of a drive, by its name
  template <class LengthOf>
  [[nodiscard]] static PairLengths lengths_of(const PairSpec& pair, LengthOf length_of) {
    PairLengths lengths;
    if (!pair.reference.empty()) lengths.reference = length_of(pair.reference);
    for (const std::string& query : pair.queries) lengths.queries.push_back(length_of(query));
    return lengths;
  }

  void check_lengths(std::size_t pair, const PairLengths& lengths, Faults& faults) const {
    const PairSpec& spec = experiment_.pairs[pair];
    static_cast<void>(pair_truth(spec, lengths, faults));
    const std::optional<std::uint64_t> queries = lengths.query();
    const std::optional<std::uint64_t> places = lengths.map(spec);
    if (!queries || !places) return;
    std::set<std::string> told;
    for (const RunSpec& run : experiment_.runs) {
      if (run.pair != pair) continue;
      Faults found;
      program::check_length(found, run.config, *queries, *places);
      for (const Fault& fault : found) {
        const std::string why = fmt::format("pair '{}', method '{}': {}: {}", spec.name, run.method,
                                            fault.what, fault.why);
        if (told.insert(why).second) faults.push_back({spec.where, why, fault.remedy});
      }
    }
  }

  std::vector<Job> leave_out_jobs() {
    std::vector<Job> jobs;
    for (std::size_t i = 0; i < experiment_.pairs.size(); ++i) {
      const PairSpec& pair = experiment_.pairs[i];
      if (!pair.leave_out) continue;
      jobs.push_back(
          {"dark and standing frames of " + pair.name,
           static_cast<double>(drives_.about(pair.queries.front())), [this, &pair, i] {
             kept_frames_[i] = leave_out(*drives_.open(pair.reference),
                                         *drives_.open(pair.queries.front()), *pair.leave_out);
             if (kept_frames_[i]->frames.empty()) {
               throw SetupError({pair.where, "pair '" + pair.name + "' has no frame left",
                                 "lower dark-below or standing-below"});
             }
           }});
    }
    return jobs;
  }

  std::vector<Job> match_jobs() const {
    std::vector<Job> jobs;
    for (const RunSpec& run : experiment_.runs) {
      if (is_done(run)) continue;
      const PairSpec& pair = experiment_.pairs[run.pair];
      std::string name = fmt::format("{}: {}, {}", pair.name, run.method,
                                     experiment_.descriptors[run.descriptor].name);
      for (const Setting& setting : run.settings) {
        const bool number = setting.value.find_first_not_of("0123456789.") == std::string::npos;
        if (number) name += fmt::format(", {} {}", setting.name, setting.value);
      }
      // What a run costs is mostly what it reads for each place: all of them, or ranges of them.
      const double share = run.config.candidates == Candidates::all ? 1.0 : 0.1;
      double bytes = 0.0;
      for (const std::string& query : pair.queries) {
        std::error_code error;  // it has gone: that is told as it is read
        const auto size = std::filesystem::file_size(drives_.file(query, run.descriptor), error);
        if (!error) bytes += static_cast<double>(size);
      }
      const auto about = [this](const std::string& drive) { return drives_.about(drive); };
      const auto places = static_cast<double>(*lengths_of(pair, about).map(pair));
      jobs.push_back({name, share * bytes * places, [this, &run] { match(run); }});
    }
    return jobs;
  }

  void match(const RunSpec& run) const {
    const PairSpec& pair = experiment_.pairs[run.pair];
    DescribedPair described = read(run);
    const std::uint64_t queries = described.query.rows;
    const std::uint64_t places = described.reference ? described.reference->rows : queries;
    PairLengths lengths;
    if (described.reference) lengths.reference = places;
    lengths.queries.assign(described.query_lengths.begin(), described.query_lengths.end());
    Faults faults;
    check_lengths(run.pair, lengths, faults);
    program::refuse(faults);  // before the truth would tell its faults once more
    const evaluation::Truth truth = pair_truth(pair, lengths, faults);
    program::refuse(std::move(faults));

    Result result{pair.name,
                  run.method,
                  experiment_.descriptors[run.descriptor].name,
                  run.settings,
                  places,
                  queries,
                  truth.frames(),
                  described.query.columns};
    const MatchedRun matched = match_pair(run, std::move(described), shown_as_matrix(run));
    result.measures = measure(matched.answers, truth, tolerance(pair.truth), truth.frames());
    result.distances = matched.distances;
    result.most_distances = matched.most_distances;
    result.candidates = matched.candidates;
    result.seconds = matched.seconds;
    result.alone = alone_;
    result.made_by = program::condition_line();
    if (shown_as_matrix(run)) {
      const auto bytes = std::as_bytes(std::span(matched.matrix_png));
      files::OutputFile out(file(run, "png"));
      out.write(bytes);
      out.commit();
      result.matrix =
          fingerprint(std::string(matched.matrix_png.begin(), matched.matrix_png.end()));
    }
    keep_result(result, file(run, "json"));
  }

  /// The pair's descriptors, without the frames that are left out.
  [[nodiscard]] DescribedPair read(const RunSpec& run) const {
    const PairSpec& pair = experiment_.pairs[run.pair];
    const auto read_drive = [&](const std::string& drive) {
      files::Matrix rows = drives_.read(drive, run.descriptor);
      const std::optional<KeptFrames>& kept = kept_frames_[run.pair];
      if (!kept) return rows;
      if (kept->frames.back() >= rows.rows) {
        throw SetupError(
            {drives_.file(drive, run.descriptor).string(),
             fmt::format("it has {}, and drive '{}' more frames", counted(rows.rows, "row"), drive),
             "describe the same frames, one row each"});
      }
      for (std::size_t i = 0; i < kept->frames.size(); ++i) {
        std::ranges::copy(rows.row(static_cast<std::size_t>(kept->frames[i])),
                          rows.values.begin() + static_cast<std::ptrdiff_t>(i * rows.columns));
      }
      rows.rows = kept->frames.size();
      rows.values.resize(rows.rows * rows.columns);
      return rows;
    };
    DescribedPair described;
    if (!pair.reference.empty()) described.reference = read_drive(pair.reference);
    for (const std::string& drive : pair.queries) {
      files::Matrix rows = read_drive(drive);
      described.query_lengths.push_back(rows.rows);
      if (described.query.rows == 0) {
        described.query = std::move(rows);
        continue;
      }
      files::Matrix& all = described.query;
      all.rows += rows.rows;
      all.values.insert(all.values.end(), rows.values.begin(), rows.values.end());
    }
    return described;
  }

  /// Where a run's result is kept; the name tells everything that it depends on.
  [[nodiscard]] std::filesystem::path file(const RunSpec& run, const char* extension) const {
    const PairSpec& pair = experiment_.pairs[run.pair];
    std::vector<std::string> from{program::program_state(),
                                  text_of(run.settings),
                                  run.method,
                                  pair.name,
                                  text_of(pair.settings),
                                  experiment_.timed ? "timed" : "",
                                  std::to_string(static_cast<int>(run.threshold_on))};
    for (const std::string& query : pair.queries) {
      from.push_back(drives_.made_from(query, run.descriptor));
    }
    if (!pair.reference.empty()) {
      from.push_back(drives_.made_from(pair.reference, run.descriptor));
    }
    if (by_file(pair.truth)) {
      from.push_back(state_of(pair.truth.file));
    }
    for (const auto& path : {pair.truth.reference_positions, pair.truth.query_positions}) {
      if (!path.empty()) from.push_back(state_of(path));
    }
    return folder_ / "runs" /
           fmt::format("{}--{}--{}.{}", file_name(pair.name), file_name(run.method),
                       fingerprint(fmt::format("{}", fmt::join(from, "\n"))), extension);
  }

  [[nodiscard]] bool is_done(const RunSpec& run) const {
    const std::optional<Result> result = kept_result(file(run, "json"));
    if (!result) return false;
    // Which run is shown as a matrix depends on the others in the file.
    return !shown_as_matrix(run) || kept_picture(run, *result);
  }

  /// The matrix of a run, as it was when the run was matched; nothing where it is not there, or
  /// somebody damaged it.
  [[nodiscard]] std::optional<std::string> kept_picture(const RunSpec& run,
                                                        const Result& result) const {
    try {
      std::string png = files::read_bytes(file(run, "png"));
      if (fingerprint(png) == result.matrix) return png;
    } catch (const SetupError&) {  // it is made anew
    }
    return std::nullopt;
  }

  /// The first run of each method, pair and descriptor whose matrix is whole, and that compares
  /// sequences.
  [[nodiscard]] bool shown_as_matrix(const RunSpec& run) const {
    const auto whole = [](const RunSpec& each) {
      return each.config.candidates == Candidates::all && each.config.sequence_length > 0;
    };
    if (!whole(run)) return false;
    const auto same = [&](const RunSpec& other) {
      return whole(other) && std::tie(other.method, other.pair) == std::tie(run.method, run.pair) &&
             experiment_.descriptors[other.descriptor].name ==
                 experiment_.descriptors[run.descriptor].name;
    };
    return &*std::ranges::find_if(experiment_.runs, same) == &run;
  }

  /// Results may be kept from other calls: what they were matched by is what they say.
  [[nodiscard]] std::vector<Setting> conditions(const std::vector<Result>& results) const {
    std::set<std::string> how;
    for (const Result& result : results) {
      how.insert(result.made_by +
                 (result.alone ? ", one run at a time" : ", runs at once: seconds do not compare"));
    }
    std::vector<Setting> all{
        {"matched by", fmt::format("{}", fmt::join(how, "; and "))},
        {"written", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)))}};
    for (std::size_t i = 0; i < experiment_.pairs.size(); ++i) {
      if (!kept_frames_[i]) continue;
      all.push_back({experiment_.pairs[i].name,
                     fmt::format("{} compared; left out: {} dark, {} standing",
                                 counted(kept_frames_[i]->frames.size(), "frame"),
                                 kept_frames_[i]->dark, kept_frames_[i]->standing)});
    }
    return all;
  }

  const Experiment& experiment_;
  std::filesystem::path folder_;
  DescribedDrives drives_;
  bool alone_ = false;                                  // no run beside another
  std::vector<std::optional<KeptFrames>> kept_frames_;  // of each pair that leaves some out
};

/// Somebody may wait for a figure or a table for which there are no results: a mistyped filter.
void tell_what_is_empty(const Report& report) {
  const auto tell = [&](const char* kind, const auto& shown) {
    if (!choose(report.results, shown.where).empty()) return;
    program::say("{} '{}': {}", kind, shown.title, nothing_to_show(shown.where));
  };
  for (const Figure& figure : report.figures) tell("figure", figure);
  for (const Table& table : report.tables) tell("table", table);
}

}  // namespace

void run_experiment(const std::filesystem::path& file, const std::filesystem::path& data,
                    const std::filesystem::path& folder, std::size_t threads, Faults faults) {
  Faults of_file;
  const Experiment experiment = read_experiment(file, data, of_file);
  opencv::use_threads(1);  // a job a core
  Runner runner(experiment, folder);
  runner.check(of_file);
  for (Fault& fault : of_file) faults.push_back(program::in_keys(std::move(fault)));
  program::refuse(std::move(faults));
  runner.run(threads);
  const Report report = runner.report();
  write_report(report, folder);
  tell_what_is_empty(report);
}

}  // namespace seqloop::experiment
