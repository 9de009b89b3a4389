// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "program/drives/drives.hpp"
#include "program/drives/map_builder.hpp"
#include "program/drives/match_drive.hpp"
#include "program/map/lasting_map.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/process/attempts.hpp"
#include "program/process/interruption.hpp"
#include "program/process/progress.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/files/descriptor_source.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/files/output_file.hpp"
#include "seqloop/linux/touched_memory.hpp"
#include "seqloop/opencv/builtin_describer.hpp"

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

/// A row of the match list.
std::string csv_row(const MatchedFrame& frame) {
  const Match& match = *frame.answer.match;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", frame.answer.frame, match.frame(),
                     precise(match.score), precise(match.uniqueness), precise(match.velocity),
                     match.head, frame.candidates, frame.k, frame.distances,
                     precise(frame.answer.probability), frame.answer.gate == Gate::match ? 1 : 0);
}

void match(const MatchSettings& settings, Faults faults) {
  take_interruptions();
  const bool closing = settings.reference.empty() && !settings.map.read_only;
  check(settings.map, !settings.reference.empty(), faults);
  MatcherConfig config =
      resolve(settings.matcher, closing ? Use::close_loops : Use::localise, faults);
  check_effects(settings.matcher, config, faults);
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
  std::unique_ptr<LastingMap> lasting;
  if (query && !settings.map.file.empty() && faults.empty()) {
    collect(faults,
            [&] { lasting = open_map(settings.map, config, query->columns, "descriptors"); });
  }
  if (query && (closing || reference)) {
    // Into a map that lasts a drive is added that closes no loop, too.
    MatcherConfig one = config;
    if (!settings.map.file.empty()) one.use = Use::localise;
    check_match(faults, one, reference ? &*reference : nullptr, *query);
  }
  refuse(std::move(faults));

  const Capacity capacity =
      lasting ? lasting->capacity(query->rows)
              : Capacity{reference ? reference->rows : query->rows, query->columns};
  suit_slice(config, settings.matcher, capacity.places);
  live::TouchedMemory memory(PlaceMap::bytes_needed(config, capacity));
  live::TouchedMemory working_memory(Detector::bytes_needed(config, capacity));
  PlaceMap map(config, capacity, memory.span(), true);
  opencv::expect_builtin(map);
  if (reference) {
    files::DescriptorSource drive(std::move(*reference));
    reference.reset();
    Progress mapping("mapping", drive.frame_count());
    const Mapped mapped = fill_map(map, drive, nullptr, config, mapping);
    tell_blank(settings.reference, mapped.blank, mapped.frames);
  }
  if (lasting) lasting->load(map);
  memory.wait();
  working_memory.wait();
  Detector detector(config, map, working_memory.span());
  const LastingMap::Saving saving =
      lasting ? lasting->begin(map, config, settings.matcher.method) : nullptr;
  Progress progress("matching", query->rows);
  MatchWatch watch{&progress, [&] {
                     if (interrupted() && lasting) lasting->discard();
                     stop_if_interrupted();
                   }};
  std::optional<std::string> unsaved;
  if (lasting) {
    watch.report = [&](const FrameReport& report) {
      lasting->note(detector, report.newest, report.newest,
                    static_cast<double>(report.newest) / frames_a_second, {}, report.answers, true);
    };
    watch.rest = [&](std::span<const Answer> rest) { unsaved = lasting->finish(detector, rest); };
  }
  const MatchedDrive matched = match_frames(detector, config, *query, watch);
  Attempts attempt;
  const bool written = attempt([&] {
    out->write(
        "query,match,score,uniqueness,velocity,head,candidates,k,distances,probability,accepted\n");
    for (const MatchedFrame& frame : matched.frames) out->write(csv_row(frame));
    out->commit();
  });
  tell_blank(settings.query, matched.blank_frames, query->rows);
  if (written) {
    say("{} of {} answered, {} of them accepted, in {}", matched.frames.size(),
        counted(query->rows, "frame"), matched.accepted(), settings.out.string());
  }
  if (lasting) say("{}: {}", settings.map.file.string(), lasting->summary());
  if (unsaved) attempt.fail(*unsaved);
  attempt.end();
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
