// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "program/drives/drive_length.hpp"
#include "program/drives/drives.hpp"
#include "program/drives/map_builder.hpp"
#include "program/map/lasting_map.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/process/interruption.hpp"
#include "program/process/progress.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/files/descriptor_source.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::program {
namespace {

struct MatchSettings {
  std::filesystem::path reference;
  std::filesystem::path query;
  std::filesystem::path out;
  MapSettings map;
  MatcherSettings matcher;
};

// Described drives say nothing of time.
constexpr double frames_a_second = 10.0;

/// NaN carries no sign here.
template <class Number>
std::string precise(Number value) {
  return std::isnan(value) ? "nan" : fmt::format("{:.9g}", value);
}

/// What the search for a frame, as the centre of its window, took.
struct Searched {
  std::uint64_t candidates = 0;
  std::size_t k = 0;
  std::uint64_t distances = 0;
};

/// A row of the match list.
std::string csv_row(const Answer& answer, const Searched& searched) {
  const Match& match = *answer.match;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", answer.frame, match.place,
                     precise(match.score), precise(match.uniqueness), precise(match.velocity),
                     match.head, searched.candidates, searched.k, searched.distances,
                     precise(answer.probability), answer.gate == Gate::match ? 1 : 0);
}

/// The answers of a recording.
class MatchList {
 public:
  /// @param frames of the recording
  MatchList(const MatcherConfig& config, std::size_t frames)
      : after_centre_(config.sequence_length - config.sequence_length / 2), searched_(frames) {}

  void add(const FrameReport& report) {
    add(report.answers);
    if (report.newest < after_centre_) return;
    searched_[static_cast<std::size_t>(report.newest - after_centre_)] = {
        report.work.candidates, report.k, report.work.distances};
  }

  void add(std::span<const Answer> answers) {
    std::ranges::copy_if(answers, std::back_inserter(answers_),
                         [](const Answer& answer) { return answer.match.has_value(); });
  }

  [[nodiscard]] std::size_t size() const noexcept { return answers_.size(); }
  [[nodiscard]] std::size_t accepted() const noexcept {
    return static_cast<std::size_t>(std::ranges::count(answers_, Gate::match, &Answer::gate));
  }

  /// A frame that was sure may have been answered before one that came before it.
  void write(files::OutputFile& out) {
    std::ranges::sort(answers_, {}, &Answer::frame);
    out.write(
        "query,match,score,uniqueness,velocity,head,candidates,k,distances,probability,accepted\n");
    for (const Answer& answer : answers_) {
      out.write(csv_row(answer, searched_[static_cast<std::size_t>(answer.frame)]));
    }
  }

 private:
  std::size_t after_centre_;
  std::vector<Answer> answers_;
  std::vector<Searched> searched_;  // by frame
};

void match(const MatchSettings& settings, Faults faults) {
  take_interruptions();
  const bool closing = settings.reference.empty() && !settings.map.read_only;
  check(settings.map, !settings.reference.empty(), faults);
  MatcherConfig config =
      resolve(settings.matcher, closing ? Use::close_loops : Use::localise, faults);
  // A recording is there whole, so that places can be read once for many frames.
  config.frames_at_once = MatcherConfig::most_frames_at_once;
  std::optional<files::Matrix> query;
  std::optional<files::Matrix> reference;
  if (settings.query.empty()) {
    faults.push_back({"query", "not given", "--query Q.npy"});
  } else {
    collect(faults, [&] { query = read_descriptors(settings.query, config.difference); });
  }
  if (!settings.reference.empty())
    collect(faults, [&] { reference = read_descriptors(settings.reference, config.difference); });
  std::unique_ptr<files::OutputFile> out;
  if (settings.out.empty()) {
    faults.push_back({"out", "not given", "--out M.csv"});
  } else {
    collect(faults, [&] { out = std::make_unique<files::OutputFile>(settings.out); });
  }
  if (query && reference && query->columns != reference->columns) {
    faults.push_back({"reference, query",
                      fmt::format("{} values in a row of one, {} in a row of the other",
                                  reference->columns, query->columns),
                      "describe both with the same model and layer"});
  }
  std::unique_ptr<LastingMap> lasting;
  if (query && !settings.map.file.empty() && faults.empty()) {
    collect(faults,
            [&] { lasting = open_map(settings.map, config, query->columns, "descriptors"); });
  }
  if (query && (closing || reference) && validate(config).empty()) {
    // Into a map that lasts a drive is added that closes no loop, too.
    MatcherConfig one = config;
    if (!settings.map.file.empty()) one.use = Use::localise;
    check_length(faults, one, query->rows, reference ? reference->rows : query->rows);
  }
  refuse(std::move(faults));

  const Capacity capacity =
      lasting ? lasting->capacity(query->rows)
              : Capacity{reference ? reference->rows : query->rows, query->columns};
  suit_slice(config, settings.matcher, capacity.places);
  PlaceMap map(config, capacity);
  if (reference) {
    files::DescriptorSource drive(std::move(*reference));
    reference.reset();
    Progress mapping("mapping", drive.frame_count());
    const std::size_t blank_places = fill_map(map, drive, nullptr, config, mapping);
    tell_blank(settings.reference, blank_places, map.size());
  }
  if (lasting) lasting->load(map);
  Detector detector(config, map);
  if (lasting) lasting->begin(map, config, settings.matcher.method);
  MatchList list(config, query->rows);
  Progress progress("matching", query->rows);
  std::size_t blank_frames = 0;
  std::vector<std::span<const float>> frames;
  std::vector<FrameReport> reports(config.frames_at_once);
  for (std::size_t row = 0; row < query->rows; row += frames.size()) {
    stop_if_interrupted();
    frames.clear();
    const std::size_t last = std::min(row + config.frames_at_once, query->rows);
    for (std::size_t next = row; next < last; ++next) {
      frames.push_back(query->row(next));
      if (blank(config.difference, frames.back())) ++blank_frames;
    }
    const std::size_t taken = detector.steps(frames, reports);
    for (const FrameReport& report : std::span(reports).first(taken)) {
      progress.step();
      list.add(report);
      if (lasting) {
        lasting->note(detector, report.newest, report.newest,
                      static_cast<double>(report.newest) / frames_a_second, report.answers);
      }
    }
  }
  const std::span<const Answer> rest = detector.finish();
  list.add(rest);
  const auto unsaved = lasting ? lasting->finish(detector, rest) : std::nullopt;
  progress.done();
  list.write(*out);
  out->commit();
  tell_blank(settings.query, blank_frames, query->rows);
  say("{} of {} frames answered, {} of them accepted, in {}", list.size(), query->rows,
      list.accepted(), settings.out.string());
  if (lasting) say("{}: {}", settings.map.file.string(), lasting->summary());
  if (unsaved) throw std::runtime_error("not all of the drive is saved: " + *unsaved);
}

}  // namespace

Verb match_verb() {
  const auto settings = std::make_shared<MatchSettings>();
  Verb verb{"match",
            "Match the descriptors of one drive with those of another, or with its own",
            {},
            [settings](Faults faults) { match(*settings, std::move(faults)); }};
  verb.options.section("Task");
  verb.options.path("reference", Access::reads, settings->reference,
                    "descriptors of the map, .npy [close loops within the query]");
  verb.options.path("query", Access::reads, settings->query, "descriptors of the drive, .npy");
  verb.options.path("out", Access::writes, settings->out, "match list, CSV");
  add_map_options(verb.options, settings->map);
  add_matcher_options(verb.options, settings->matcher);
  return verb;
}

}  // namespace seqloop::program
