// SPDX-License-Identifier: MIT
// Reads an experiment file: sections in the order in which they refer to each other.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>
#include <utility>

#include "experiment/run/experiment.hpp"
#include "experiment/run/section.hpp"
#include "experiment/run/shown_sections.hpp"
#include "files/text_file.hpp"
#include "program/drives/stills_options.hpp"
#include "program/options/verb.hpp"

namespace seqloop::experiment {
namespace {

using program::OptionTable;

template <class Named>
Names names_of(const std::vector<Named>& all) {
  Names names;
  for (const Named& named : all) names.push_back(named.name);
  return names;
}

/// What a key is called in results, where `method` and `descriptor` are the names of sections.
std::string name_in_results(const std::string& key) {
  return key == "method" ? "algorithm" : key == "descriptor" ? "kind" : key;
}

bool has(const Names& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, std::filesystem::path data, Faults& faults)
      : file_(file.string()), data_(std::move(data)), faults_(faults) {}

  Experiment read(std::string_view text) {
    const toml::table root = program::parse_toml(text, file_);
    read_head(root);
    each(root, "drive", [&](const Section& section) { read_drive(section); });
    each(root, "descriptor", [&](const Section& section) { read_descriptor(section); });
    each(root, "pair", [&](const Section& section) { read_pair(section); });
    each(root, "method", [&](const Section& section) { read_method(section); });
    each(root, "figure",
         [&](const Section& section) { experiment_.figures.push_back(read_figure(section)); });
    each(root, "table",
         [&](const Section& section) { experiment_.tables.push_back(read_table(section)); });
    if (experiment_.runs.empty() && faults_.empty()) {
      faults_.push_back(
          {file_, "there is nothing to run in it", "add a [[pair]] and a [[method]]"});
    }
    return std::move(experiment_);
  }

 private:
  void read_head(const toml::table& root) {
    OptionTable options;
    std::string threshold = "uniqueness";
    std::string data;
    options.text("title", experiment_.title, "");
    options.text("text", experiment_.text, "");
    options.flag("timed", experiment_.timed, "");
    options.text("data", data, "");
    options.text("threshold-on", threshold, "");
    Section(root, file_, faults_)
        .set_all(options, {"drive", "descriptor", "pair", "method", "figure", "table"});
    try {
      experiment_.threshold_on = program::parse_threshold(threshold);
    } catch (const std::invalid_argument& why) {
      faults_.push_back({program::where(file_, *root.get("threshold-on")),
                         std::string("'threshold-on': ") + why.what()});
    }
    const std::filesystem::path file(file_);
    if (data_.empty()) data_ = file.parent_path() / data;
    if (experiment_.title.empty()) experiment_.title = file.stem().string();
  }

  template <class Read>
  void each(const toml::table& root, const char* kind, Read read) {
    const toml::node* node = root.get(kind);
    if (node == nullptr) return;
    const toml::array* list = node->as_array();
    if (list == nullptr || !list->is_array_of_tables()) {
      faults_.push_back({program::where(file_, *node),
                         fmt::format("'{}' must be a list of tables: [[{}]]", kind, kind)});
      return;
    }
    for (const toml::node& section : *list) read(Section(*section.as_table(), file_, faults_));
  }

  /// Makes a path what it is seen from here, and takes note of it.
  void find(std::filesystem::path& path) {
    if (path.empty()) return;
    if (path.is_relative()) path = (data_ / path).lexically_normal();
    experiment_.inputs.push_back(path);
  }

  void read_drive(const Section& section) {
    DriveSpec drive;
    drive.where = section.where();
    drive.name = section.name("drive", names_of(experiment_.drives));
    OptionTable options;
    options.path("source", program::Access::reads, drive.source, "");
    options.number("fps", drive.fps, "");
    add_stills_options(options, drive.stills);
    drive.settings = section.set_all(options, {"name", "leave-out"});
    read_leave_out(section, drive);
    if (!(drive.fps >= 1e-3 && drive.fps <= 1e6)) {
      section.refuse("'fps' must be between 0.001 and 1000000");
    }
    if (drive.source.empty() && !drive.settings.empty()) {
      section.refuse("drive '" + drive.name + "' has no source, which the rest is about");
    }
    find(drive.source);
    for (const Fault& fault : validate(drive.stills)) {
      section.refuse(fault.what + ": " + fault.why, fault.remedy);
    }
    experiment_.drives.push_back(std::move(drive));
  }

  /// Spans, or a file of them, which may change while its name does not.
  void read_leave_out(const Section& section, DriveSpec& drive) {
    for (const std::string& text : section.names("leave-out")) {
      std::filesystem::path file = text;
      find(file);
      std::error_code error;
      const bool is_file = std::filesystem::exists(file, error);
      try {
        std::ranges::copy(program::parse_intervals(is_file ? file.string() : text),
                          std::back_inserter(drive.stills.leave_out));
      } catch (const std::invalid_argument& why) {
        section.refuse(std::string("'leave-out': ") + why.what());
      }
    }
    for (const program::Interval& span : drive.stills.leave_out) {
      drive.settings.push_back({"leave-out", fmt::format("{}-{}", span.from_s, span.to_s)});
    }
  }

  void read_descriptor(const Section& section) {
    const std::string name = section.name("descriptor", names_of(experiment_.descriptors));
    const Names training = section.references("training", "drive", names_of(experiment_.drives));
    program::DriveSettings none;
    OptionTable known;
    add_drive_options(known, none);
    if (section.has("fps")) section.refuse("'fps' belongs to a [[drive]]");
    if (section.has("topic"))
      section.refuse("'topic' chooses nothing in an experiment", "give bags with one topic only");
    const Names described = section.names("described");
    if (described.size() > 1) section.refuse("'described' is one folder");
    if (described.size() == 1 && described.front().empty()) {
      section.refuse("'described': its value is empty", "give one, or leave it out");
    }
    const auto written = section.written(known, {"name", "training", "fps", "topic", "described"});
    if (!described.empty() && !(written.empty() && training.empty())) {
      section.refuse("descriptor '" + name + "' has been described elsewhere",
                     "leave out 'described', or all else but its name");
    }
    for (const std::vector<Setting>& chosen : section.combinations(written)) {
      DescriptorSpec descriptor{name, section.where(), {}, {}, training, chosen, {}};
      if (!described.empty()) descriptor.described = described.front();
      find(descriptor.described);
      OptionTable options;
      add_drive_options(options, descriptor.describer);
      section.set(options, written, chosen);
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (written[i].values.size() > 1) descriptor.swept.push_back(chosen[i]);
      }
      find(descriptor.describer.model.model);
      find(descriptor.describer.model.config_model);
      experiment_.descriptors.push_back(std::move(descriptor));
    }
  }

  void read_pair(const Section& section) {
    PairSpec pair;
    pair.where = section.where();
    pair.name = section.name("pair", pairs_);
    pairs_.push_back(pair.name);
    const Names reference = section.references("reference", "drive", names_of(experiment_.drives));
    if (reference.size() > 1) section.refuse("'reference' is one drive");
    if (!reference.empty()) pair.reference = reference.front();
    pair.queries = section.references("query", "drive", names_of(experiment_.drives));
    if (!section.has("query")) section.refuse("pair '" + pair.name + "' has no query drive");
    LeaveOutRule rule{.dark_below = 0.0, .standing_below = 0.0};
    OptionTable options;
    add_truth_options(options, pair.truth);
    options.number("dark-below", rule.dark_below, "");
    options.number("standing-below", rule.standing_below, "");
    pair.settings = section.set_all(options, {"name", "reference", "query"});
    if (by_file(pair.truth)) find(pair.truth.file);
    find(pair.truth.reference_positions);
    find(pair.truth.query_positions);
    if (rule.dark_below > 0.0 || rule.standing_below > 0.0) pair.leave_out = rule;
    check_pair(section, pair, rule);
    // What refers to drives that are not there cannot be looked at any further.
    if (pair.queries.empty() || (section.has("reference") && pair.reference.empty())) return;
    experiment_.pairs.push_back(std::move(pair));
  }

  static void check_pair(const Section& section, const PairSpec& pair, const LeaveOutRule& rule) {
    const bool closing = !section.has("reference");
    if (closing && by_identity(pair.truth) && pair.queries.size() < 2) {
      section.refuse(
          "pair '" + pair.name + "' closes loops within a drive, where no frame is its own truth",
          "give a truth = \"FILE.csv\" or \"no-revisit\", a second query drive, or a reference "
          "drive");
    }
    if (!closing && by_identity(pair.truth) && pair.queries.size() > 1) {
      section.refuse("pair '" + pair.name +
                         "' has several query drives, whose frames i are not those "
                         "of the reference",
                     "give a truth = \"FILE.csv\", or a pair for each");
    }
    if (closing && !pair.truth.reference_positions.empty()) {
      section.refuse(
          "pair '" + pair.name + "' closes loops within a drive, where every frame is near itself",
          "leave reference-positions out, so that only earlier frames count that the robot had "
          "left");
    }
    if (!closing && !pair.truth.query_positions.empty() && pair.truth.reference_positions.empty()) {
      section.refuse(
          "pair '" + pair.name + "' has a reference drive, whose positions are not given",
          "reference-positions = \"FILE.csv\"");
    }
    for (const double grey : {rule.dark_below, rule.standing_below}) {
      if (!(grey >= 0.0 && grey <= 255.0)) {
        section.refuse("dark-below and standing-below are grey levels, 0 to 255");
      }
    }
    const bool two_drives = !closing && pair.queries.size() == 1;
    if (pair.leave_out && (!two_drives || !by_identity(pair.truth))) {
      section.refuse("pair '" + pair.name +
                         "' leaves frames out, which wants two drives whose frames i belong "
                         "together",
                     "leave out dark-below and standing-below, or the truth");
    }
  }

  void read_method(const Section& section) {
    const std::string name = section.name("method", methods_);
    methods_.push_back(name);
    const Names descriptors =
        section.references("descriptor", "descriptor", names_of(experiment_.descriptors));
    const Names pairs = section.has("pair") ? section.references("pair", "pair", pairs_) : pairs_;
    if (!section.has("descriptor")) section.refuse("method '" + name + "' has no descriptor");
    const Names best_of = section.names("best-of");
    if (best_of.size() > 1) section.refuse("'best-of' is one setting");
    for (const std::string& setting : best_of) {
      section.check_setting(setting);
      experiment_.best_of.push_back({name, name_in_results(setting)});
    }
    const evaluation::ThresholdOn threshold_on = read_threshold(section);
    program::MatcherSettings none;
    OptionTable known;
    add_matcher_options(known, none);
    const auto written =
        section.written(known, {"name", "descriptor", "pair", "best-of", "threshold-on"});
    for (const std::string& setting : best_of) {
      if (!is_swept(setting, written, descriptors)) {
        section.refuse("'best-of': '" + setting + "' has one value only", "give it a list");
      }
    }
    std::set<std::string> told;  // what is wrong with one combination is wrong with others
    for (const std::vector<Setting>& chosen : section.combinations(written)) {
      program::MatcherSettings matcher;
      matcher.method.clear();  // no default here: a report says what it compares
      OptionTable options;
      add_matcher_options(options, matcher);
      section.set(options, written, chosen);
      for (const Fault& fault : add_runs(name, matcher, chosen, descriptors, pairs, threshold_on)) {
        const std::string why = fmt::format("method '{}': {}: {}", name, fault.what, fault.why);
        if (told.insert(why).second) section.refuse(why, fault.remedy);
      }
    }
  }

  /// The method's own `threshold-on`, or the experiment's.
  [[nodiscard]] evaluation::ThresholdOn read_threshold(const Section& section) const {
    const Names own = section.names("threshold-on");
    if (own.size() > 1) section.refuse("'threshold-on' is one column");
    if (own.empty()) return experiment_.threshold_on;
    try {
      return program::parse_threshold(own.front());
    } catch (const std::invalid_argument& why) {
      section.refuse(std::string("threshold-on: ") + why.what());
    }
    return experiment_.threshold_on;
  }

  [[nodiscard]] bool is_swept(const std::string& setting,
                              const std::vector<program::WrittenOption>& written,
                              const Names& descriptors) const {
    const std::string wanted = name_in_results(setting);
    const auto by_method = [&](const program::WrittenOption& option) {
      return name_in_results(option.option->name) == wanted && option.values.size() > 1;
    };
    const auto by_descriptor = [&](const DescriptorSpec& descriptor) {
      return has(descriptors, descriptor.name) &&
             std::ranges::any_of(descriptor.swept, [&](const Setting& swept) {
               return name_in_results(swept.name) == wanted;
             });
    };
    return std::ranges::any_of(written, by_method) ||
           std::ranges::any_of(experiment_.descriptors, by_descriptor);
  }

  /// One run for each of the pairs and each of the descriptors.
  Faults add_runs(const std::string& method, const program::MatcherSettings& matcher,
                  const std::vector<Setting>& chosen, const Names& descriptors, const Names& pairs,
                  evaluation::ThresholdOn threshold_on) {
    Faults faults;
    static_cast<void>(
        resolve(matcher, Use::localise, faults));  // without any pair or descriptor, too
    for (std::size_t d = 0; d < experiment_.descriptors.size(); ++d) {
      const DescriptorSpec& descriptor = experiment_.descriptors[d];
      if (!has(descriptors, descriptor.name)) continue;
      if ((descriptor.describer.descriptor == "patches") != compares_patches(matcher)) {
        faults.push_back({"descriptor", "'" + descriptor.name + "' does not go with it",
                          compares_patches(matcher)
                              ? "it compares patches: add a [[descriptor]] with descriptor = "
                                "\"patches\", and name that"
                              : "only seqslam compares patches: name another one"});
      }
      for (std::size_t p = 0; p < experiment_.pairs.size(); ++p) {
        const PairSpec& pair = experiment_.pairs[p];
        if (!has(pairs, pair.name)) continue;
        const Use use = pair.reference.empty() ? Use::close_loops : Use::localise;
        RunSpec run{method, d, p, threshold_on, matcher, resolve(matcher, use, faults), chosen};
        run.settings.insert(run.settings.end(), descriptor.swept.begin(), descriptor.swept.end());
        for (Setting& setting : run.settings) setting.name = name_in_results(setting.name);
        // Measures that go by a threshold compare only where it is known which one.
        run.settings.push_back({"threshold-on", name_of(threshold_on)});
        if (threshold_on == evaluation::ThresholdOn::probability &&
            run.config.decision == Decision::uniqueness) {
          faults.push_back({"threshold-on",
                            "the uniqueness decides, and no answer has a probability",
                            "threshold-on = \"uniqueness\" in this [[method]]"});
        }
        experiment_.runs.push_back(std::move(run));
      }
    }
    return faults;
  }

  std::string file_;
  std::filesystem::path data_;
  Experiment experiment_;
  Names pairs_;
  Names methods_;
  Faults& faults_;
};

}  // namespace

const DriveSpec& Experiment::drive(const std::string& name) const {
  return *std::ranges::find(drives, name, &DriveSpec::name);
}

Experiment read_experiment(const std::filesystem::path& file, const std::filesystem::path& data,
                           Faults& faults) {
  Experiment experiment;
  program::collect(
      faults, [&] { experiment = parse_experiment(files::read_text(file), file, data, faults); });
  return experiment;
}

Experiment parse_experiment(std::string_view text, const std::filesystem::path& file,
                            const std::filesystem::path& data, Faults& faults) {
  Experiment experiment;
  program::collect(faults, [&] { experiment = Reader(file, data, faults).read(text); });
  return experiment;
}

}  // namespace seqloop::experiment
