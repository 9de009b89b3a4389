// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "evaluation/measures.hpp"
#include "program/options/truth_settings.hpp"
#include "program/process/interruption.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"

namespace seqloop::program {
namespace {

struct EvalSettings {
  std::filesystem::path matches;
  TruthSettings truth;
  std::size_t frames = 0;
  std::optional<evaluation::ThresholdOn> threshold_on;  ///< uniqueness, when nobody says
  bool json = false;
  std::filesystem::path experiment;
  std::filesystem::path out;
  std::string data;
  std::size_t jobs = 0;  ///< 0: as many as there are cores
};

nlohmann::ordered_json as_json(const evaluation::Reliability& reliability) {
  auto bins = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < reliability.size(); ++i) {
    const auto edge = [&](std::size_t at) {
      return static_cast<double>(at) / static_cast<double>(reliability.size());
    };
    bins.push_back({{"from", edge(i)},
                    {"to", edge(i + 1)},
                    {"count", reliability[i].count},
                    {"mean_probability", reliability[i].mean_probability()},
                    {"share_right", reliability[i].share_right()}});
  }
  return bins;
}

/// What is not defined is NaN, which JSON writes as null.
nlohmann::ordered_json as_json(const evaluation::Measures& measures, std::uint64_t frames) {
  nlohmann::ordered_json json{
      {"frames", frames},
      {"answered", measures.answered},
      {"correct", measures.correct},
      {"unknown", measures.unknown},
      {"precision", measures.precision},
      {"recall", measures.recall},
      {"recall_at_100_precision", measures.recall_at_100_precision},
      {"area_under_curve", measures.area_under_curve},
      {"accepted", nullptr},
      {"accepted_precision", measures.accepted_precision},
      {"accepted_recall", measures.accepted_recall},
      {"expected_calibration_error", expected_calibration_error(measures.reliability)},
      {"reliability", as_json(measures.reliability)},
  };
  if (measures.accepted) json["accepted"] = *measures.accepted;
  return json;
}

/// A line of a share; `–` where it is not defined.
void print_share(double share, std::string_view name) {
  fmt::print("{:>8} {}\n", std::isnan(share) ? "–" : fmt::format("{:.3f}", share), name);
}

void print_words(const evaluation::Measures& measures, std::uint64_t frames,
                 const std::string& near) {
  fmt::print("{:>8} {} a truth\n{:>8} answered, {} of them right (within {})\n", frames,
             frames == 1 ? "query has" : "queries have", measures.answered, measures.correct, near);
  if (measures.unknown > 0) {
    fmt::print("{:>8} more to frames that the truth does not list\n", measures.unknown);
  }
  print_share(measures.precision, "precision");
  print_share(measures.recall, "recall");
  print_share(measures.recall_at_100_precision, "recall at 100 % precision");
  print_share(measures.area_under_curve, "area under the curve");
  if (measures.accepted) {
    fmt::print("{:>8} accepted\n", *measures.accepted);
    print_share(measures.accepted_precision, "precision of what is accepted");
    print_share(measures.accepted_recall, "recall of what is accepted");
  }
  const double error = expected_calibration_error(measures.reliability);
  if (std::isnan(error)) return;
  print_share(error, "expected calibration error");
  fmt::print("\n  said        answers  mean  right\n");
  for (std::size_t i = 0; i < measures.reliability.size(); ++i) {
    const evaluation::ReliabilityBin& bin = measures.reliability[i];
    if (bin.count == 0) continue;
    fmt::print("  {:.1f} to {:.1f} {:>8} {:.3f}  {:.3f}\n", static_cast<double>(i) / 10.0,
               static_cast<double>(i + 1) / 10.0, bin.count, bin.mean_probability(),
               bin.share_right());
  }
}

void eval_matches(const EvalSettings& settings, Faults faults) {
  std::vector<evaluation::Answer> answers;
  const evaluation::ThresholdOn threshold_on =
      settings.threshold_on.value_or(evaluation::ThresholdOn::uniqueness);
  if (settings.matches.empty()) faults.push_back({"matches", "not given", "--matches M.csv"});
  if (!settings.matches.empty()) {
    collect(faults, [&] { answers = evaluation::read_answers(settings.matches, threshold_on); });
  }
  const JudgedBy judge = judge_by(settings.truth, read_truth(settings.truth, faults),
                                  settings.frames, answers, faults);
  refuse(std::move(faults));
  if (by_identity(settings.truth) && settings.frames == 0) {
    say("recall is over the first {} frames only, as far as the answers reach; --frames N says how "
        "many the drive has",
        judge.frames);
  }
  const auto unswept = [](const evaluation::Answer& answer) {
    return std::isnan(answer.uncertainty);
  };
  if (!answers.empty() && std::ranges::all_of(answers, unswept)) {
    say("no answer has a {}, so that all enter the curve at once; choose another --threshold-on",
        name_of(threshold_on));
  }
  const auto nowhere = std::ranges::count_if(answers, [&](const evaluation::Answer& answer) {
    return judge.truth.judges(answer.query, answer.match) && !judge.truth.knows(answer.match);
  });
  if (nowhere > 0) {
    say("{} of {} answers name a place that has no position, and count as wrong; "
        "--unlisted unknown leaves them out",
        nowhere, answers.size());
  }
  const evaluation::Measures measures =
      measure(answers, judge.truth, tolerance(settings.truth), judge.frames);
  if (settings.json) {
    fmt::print("{}\n", as_json(measures, judge.frames).dump(2));
  } else {
    print_words(measures, judge.frames, how_near(settings.truth, judge.truth));
  }
}

/// What belongs to match lists only, and what to experiments only.
void eval(const EvalSettings& settings, const ExperimentRunner& run_experiment, Faults faults) {
  if (settings.experiment.empty()) {
    refuse_given(faults,
                 {{"out", !settings.out.empty()},
                  {"data", !settings.data.empty()},
                  {"jobs", settings.jobs > 0}},
                 "it goes with an experiment", "--experiment E.toml");
    eval_matches(settings, std::move(faults));
    return;
  }
  take_interruptions();
  const bool truth_given = !settings.truth.file.empty() || settings.truth.tolerance ||
                           !settings.truth.reference_positions.empty() ||
                           !settings.truth.query_positions.empty() || settings.truth.radius_m ||
                           settings.truth.unlisted;
  refuse_given(faults,
               {{"matches", !settings.matches.empty()},
                {"truth, tolerance, positions, radius, unlisted", truth_given},
                {"frames", settings.frames > 0},
                {"threshold-on", settings.threshold_on.has_value()}},
               "an experiment says it in its file", "leave it out here");
  refuse_given(faults, {{"json", settings.json}}, "an experiment's numbers are in its folder",
               "leave it out, and read results.csv there");
  if (settings.out.empty()) faults.push_back({"out", "not given", "--out FOLDER"});
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  try {
    run_experiment(settings.experiment, settings.data, settings.out,
                   settings.jobs > 0 ? settings.jobs : cores, std::move(faults));
  } catch (const std::exception&) {
    if (!interrupted()) throw;
    throw std::runtime_error("interrupted: what is done is kept, and the same command goes on");
  }
  say("the report is {}", (settings.out / "index.html").string());
}

}  // namespace

Verb eval_verb(ExperimentRunner run_experiment) {
  const auto settings = std::make_shared<EvalSettings>();
  Verb verb{"eval",
            "Compare a match list with the truth, or run a whole experiment",
            {},
            [settings, run_experiment = std::move(run_experiment)](Faults faults) {
              eval(*settings, run_experiment, std::move(faults));
            }};
  verb.options.section("Answers");
  verb.options.path("matches", Access::reads, settings->matches,
                    "answers: the match list (CSV) of `match`, or the JSON lines of `run`");
  add_truth_options(verb.options, settings->truth);
  verb.options.add(
      {"threshold-on", ValueKind::text,
       "what the curve sweeps: uniqueness, score or probability [uniqueness]",
       [settings](std::string_view value) { settings->threshold_on = parse_threshold(value); }});
  verb.options.count(
      "frames", settings->frames,
      "queries that have a truth [0: as the truth file says, or as far as the matches reach]");
  verb.options.flag("json", settings->json, "print JSON");
  verb.options.section("Experiment");
  verb.options.path("experiment", Access::reads, settings->experiment,
                    "methods x parameters x drives to run, TOML; goes on where it was interrupted");
  verb.options.folder("out", settings->out, {"index.html", "results.csv"},
                      "experiment: folder for the report, and what it keeps");
  verb.options.text("data", settings->data,
                    "experiment: where its relative paths start [as the file says]");
  verb.options.count("jobs", settings->jobs, "experiment: runs at once [one a core]");
  return verb;
}

}  // namespace seqloop::program
