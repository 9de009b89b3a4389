#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "evaluation/measures.hpp"
#include "seqloop/verb.hpp"

namespace seqloop::program {
namespace {

struct EvalSettings {
  std::filesystem::path matches;
  std::string truth = "identity";
  std::size_t tolerance = 2;
  std::size_t frames = 0;
  evaluation::ThresholdOn threshold_on = evaluation::ThresholdOn::uniqueness;
  bool json = false;
};

evaluation::ThresholdOn parse_threshold(std::string_view text) {
  if (text == "uniqueness") return evaluation::ThresholdOn::uniqueness;
  if (text == "score") return evaluation::ThresholdOn::score;
  throw std::invalid_argument("'" + std::string(text) + "' is neither uniqueness nor score");
}

/// Identity needs to know how many queries there are: as many as asked, or as the matches reach.
std::uint64_t identity_frames(const EvalSettings& settings,
                              const std::vector<evaluation::Answer>& answers) {
  if (settings.frames > 0) return settings.frames;
  std::uint64_t frames = 0;
  for (const evaluation::Answer& answer : answers) frames = std::max(frames, answer.query + 1);
  return frames;
}

void eval(const EvalSettings& settings, Faults faults) {
  std::vector<evaluation::Answer> answers;
  evaluation::Truth truth;
  const bool identity = settings.truth == "identity";
  if (settings.matches.empty()) faults.push_back({"matches", "not given", "--matches M.csv"});
  if (!settings.matches.empty()) {
    collect(faults, [&] {
      answers = evaluation::read_answers(evaluation::CsvTable::read(settings.matches),
                                         settings.threshold_on);
    });
  }
  if (!identity) {
    collect(faults, [&] {
      truth = evaluation::Truth::from_csv(evaluation::CsvTable::read(settings.truth));
    });
  }
  if (!identity && settings.frames > 0 && settings.frames < truth.frames()) {
    faults.push_back(
        {"frames",
         fmt::format("{} is fewer than the truth file has, {}", settings.frames, truth.frames()),
         "leave --frames out"});
  }
  refuse(std::move(faults));
  if (identity) truth = evaluation::Truth::identity(identity_frames(settings, answers));

  const std::uint64_t frames = settings.frames > 0 ? settings.frames : truth.frames();
  const evaluation::Measures measures = measure(answers, truth, settings.tolerance, frames);
  if (settings.json) {
    const nlohmann::ordered_json json{
        {"frames", frames},
        {"answered", measures.answered},
        {"correct", measures.correct},
        {"precision", measures.precision},
        {"recall", measures.recall},
        {"recall_at_100_precision", measures.recall_at_100_precision},
        {"area_under_curve", measures.area_under_curve},
    };
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("{:>8} queries have a truth\n{:>8} answered, {} of them right (within {} frames)\n",
             frames, measures.answered, measures.correct, settings.tolerance);
  fmt::print("{:>8.3f} precision\n{:>8.3f} recall\n", measures.precision, measures.recall);
  fmt::print("{:>8.3f} recall at 100 % precision\n{:>8.3f} area under the curve\n",
             measures.recall_at_100_precision, measures.area_under_curve);
}

}  // namespace

Verb eval_verb() {
  const auto settings = std::make_shared<EvalSettings>();
  Verb verb{"eval", "Compare a match list with the truth", {}, [settings](Faults faults) {
              eval(*settings, std::move(faults));
            }};
  verb.options.path("matches", settings->matches, "match list (CSV), as `match` writes it");
  verb.options.text("truth", settings->truth, "identity, or a CSV file query,reference [identity]");
  verb.options.count("tolerance", settings->tolerance, "frames by which a match may be off [2]");
  verb.options.add(
      {"threshold-on", ValueKind::text, "what the curve sweeps: uniqueness or score [uniqueness]",
       [settings](std::string_view value) { settings->threshold_on = parse_threshold(value); }});
  verb.options.count(
      "frames", settings->frames,
      "queries that have a truth [as the truth file says, or as far as the matches reach]");
  verb.options.flag("json", settings->json, "print JSON");
  return verb;
}

}  // namespace seqloop::program
