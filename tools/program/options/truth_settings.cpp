// SPDX-License-Identifier: MIT
#include "program/options/truth_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "program/options/verb.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::program {
namespace {

constexpr double default_radius_m = 25.0;

bool by_positions(const TruthSettings& settings) {
  return !settings.reference_positions.empty() || !settings.query_positions.empty();
}

evaluation::Unlisted unlisted(const TruthSettings& settings) {
  return settings.unlisted.value_or(evaluation::Unlisted::wrong);
}

evaluation::Unlisted parse_unlisted(std::string_view text) {
  if (text == "wrong") return evaluation::Unlisted::wrong;
  if (text == "unknown") return evaluation::Unlisted::unknown;
  throw std::invalid_argument("'" + std::string(text) + "' is neither wrong nor unknown");
}

/// Every frame is near itself, so that every frame of a first lap would count as missed.
void refuse_one_file(const TruthSettings& truth, Faults& faults) {
  std::error_code none_there;
  if (!std::filesystem::equivalent(truth.reference_positions, truth.query_positions, none_there)) {
    return;
  }
  faults.push_back({"reference-positions, query-positions",
                    "they are one file, and every frame is near itself",
                    "leave --reference-positions out where loops are closed within the drive; "
                    "--truth identity where frames i of two drives belong together"});
}

evaluation::Truth read_positions(const TruthSettings& settings, Faults& faults) {
  refuse_one_file(settings, faults);
  std::optional<evaluation::Positions> reference;
  std::optional<evaluation::Positions> query;
  const auto read = [&](auto& into, const std::filesystem::path& file) {
    if (file.empty()) return;
    collect(faults,
            [&] { into = evaluation::Positions::from_csv(evaluation::CsvTable::read(file)); });
  };
  read(reference, settings.reference_positions);
  read(query, settings.query_positions);
  if (settings.query_positions.empty()) {
    faults.push_back(
        {"query-positions", "not given, but the other drive's are", "--query-positions FILE.csv"});
  }
  if (!settings.file.empty()) {
    faults.push_back({"truth", "positions are given too", "leave one of them out"});
  }
  if (settings.tolerance) {
    faults.push_back({"tolerance", "it counts frames, and positions are given", "--radius METRES"});
  }
  evaluation::Truth truth;
  const double radius_m = settings.radius_m.value_or(default_radius_m);
  if (query && settings.reference_positions.empty()) {
    collect(faults, [&] {
      truth = evaluation::Truth::loops_from_positions(*query, radius_m, unlisted(settings));
    });
  } else if (reference && query) {
    collect(faults, [&] {
      truth = evaluation::Truth::from_positions(std::move(*reference), *query, radius_m,
                                                unlisted(settings));
    });
  } else if (!(radius_m > 0.0)) {
    faults.push_back({"radius", "it must be above 0 metres"});
  }
  return truth;
}

}  // namespace

void add_truth_options(OptionTable& options, TruthSettings& settings) {
  options.path("truth", Access::reads, settings.file,
               "identity, no-revisit (every answer is wrong), or a CSV file query,reference and, "
               "where a row has its own, tolerance [identity]");
  options.add({"tolerance", ValueKind::count,
               "frames by which a match may be off; not with positions [2]",
               [&settings](std::string_view value) { settings.tolerance = parse_count(value); }});
  options.path("reference-positions", Access::reads, settings.reference_positions,
               "truth by where frames were: CSV frame,x,y (metres) or "
               "frame,latitude,longitude (degrees)");
  options.path(
      "query-positions", Access::reads, settings.query_positions,
      "likewise, of the queries; alone: of a drive whose loops are closed, in which earlier frames "
      "count that the robot had left");
  options.add({"radius", ValueKind::number, "metres by which a match may be off [25]",
               [&settings](std::string_view value) { settings.radius_m = parse_number(value); }});
  options.add(
      {"unlisted", ValueKind::text,
       "answers to frames that the truth does not list are wrong or unknown (not counted) [wrong]",
       [&settings](std::string_view value) { settings.unlisted = parse_unlisted(value); }});
}

std::size_t tolerance(const TruthSettings& settings) {
  constexpr std::size_t usual = 2;
  return settings.tolerance.value_or(usual);
}

bool by_identity(const TruthSettings& settings) {
  return settings.file == "identity" || (settings.file.empty() && !by_positions(settings));
}

bool by_file(const TruthSettings& settings) {
  return !settings.file.empty() && settings.file != "identity" && settings.file != "no-revisit";
}

evaluation::Truth read_truth(const TruthSettings& settings, Faults& faults) {
  evaluation::Truth truth;
  if (by_positions(settings)) {
    truth = read_positions(settings, faults);
  } else if (settings.radius_m) {
    faults.push_back({"radius", "it goes with positions, and none are given",
                      "--reference-positions R.csv --query-positions Q.csv"});
  }
  if (by_file(settings)) {
    collect(faults, [&] {
      truth = evaluation::Truth::from_csv(evaluation::CsvTable::read(settings.file),
                                          unlisted(settings));
    });
  } else if (settings.unlisted && !by_positions(settings)) {
    faults.push_back({"unlisted", "it goes with a truth that lists frames", "--truth T.csv"});
  }
  return truth;
}

JudgedBy judge_by(const TruthSettings& settings, evaluation::Truth truth, std::uint64_t frames,
                  std::span<const evaluation::Answer> answers, Faults& faults) {
  if (by_identity(settings)) {
    if (frames == 0) {
      for (const evaluation::Answer& answer : answers) frames = std::max(frames, answer.query + 1);
    }
    return {evaluation::Truth::identity(frames), frames};
  }
  if (frames > 0 && frames < truth.frames()) {
    faults.push_back({"frames",
                      fmt::format("{} is fewer than have a truth, {}", frames, truth.frames()),
                      "leave --frames out"});
  }
  if (frames == 0) frames = truth.frames();
  return {std::move(truth), frames};
}

evaluation::ThresholdOn parse_threshold(std::string_view text) {
  if (text == "uniqueness") return evaluation::ThresholdOn::uniqueness;
  if (text == "score") return evaluation::ThresholdOn::score;
  if (text == "probability") return evaluation::ThresholdOn::probability;
  throw std::invalid_argument("'" + std::string(text) +
                              "' is none of uniqueness, score, probability");
}

std::string how_near(const TruthSettings& settings, const evaluation::Truth& truth) {
  if (by_positions(settings)) {
    const double radius_m = settings.radius_m.value_or(default_radius_m);
    return fmt::format("{} metre{}", radius_m, radius_m == 1.0 ? "" : "s");
  }
  std::string asked = counted(tolerance(settings), "frame");
  switch (truth.own_tolerances()) {
    case evaluation::OwnTolerances::all:
      return "the truth's own tolerances";
    case evaluation::OwnTolerances::some:
      return "the truth's own tolerances, otherwise " + asked;
    case evaluation::OwnTolerances::none:
      break;
  }
  return asked;
}

}  // namespace seqloop::program
