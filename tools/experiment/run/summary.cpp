// SPDX-License-Identifier: MIT
#include "experiment/run/summary.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "experiment/run/fingerprint.hpp"

namespace seqloop::experiment {
namespace {

/// The exhaustive search that A- and O- are measured against.
MatcherConfig exhaustive(MatcherConfig config) {
  const MatcherConfig paper;
  config.candidates = Candidates::all;
  config.k = paper.k;
  config.initial_k = paper.initial_k;
  config.num = paper.num;
  config.reinit = paper.reinit;
  return config;
}

bool better(const Result& a, const Result& b) {
  const auto rank = [](const Result& result) {
    return std::pair(result.measures.recall_at_100_precision, result.measures.area_under_curve);
  };
  return rank(a) > rank(b);
}

}  // namespace

void add_speed_ups(const Experiment& experiment, std::vector<Result>& results) {
  const std::vector<RunSpec>& runs = experiment.runs;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto full = std::ranges::find_if(runs, [&](const RunSpec& run) {
      return run.config.candidates == Candidates::all && run.pair == runs[i].pair &&
             run.descriptor == runs[i].descriptor &&
             exhaustive(run.config) == exhaustive(runs[i].config);
    });
    if (full == runs.end()) continue;
    const Result& whole = results[static_cast<std::size_t>(full - runs.begin())];
    const bool comparable = whole.alone && results[i].alone && whole.made_by == results[i].made_by;
    if (!comparable) continue;
    results[i].speed_up = whole.seconds / results[i].seconds;
  }
}

void add_best(const Experiment& experiment, std::vector<Result>& results) {
  for (const BestOf& best_of : experiment.best_of) {
    // In the order of the file.
    std::vector<std::pair<std::string, Result>> best;
    for (const Result& result : results) {
      if (result.method != best_of.method) continue;
      std::vector<Setting> others = result.settings;
      std::erase_if(others, [&](const Setting& each) { return each.name == best_of.setting; });
      const std::string group = result.pair + ';' + result.descriptor + ';' + text_of(others);
      const auto found = std::ranges::find(best, group, &std::pair<std::string, Result>::first);
      if (found == best.end()) {
        best.emplace_back(group, result);
      } else if (better(result, found->second)) {
        found->second = result;
      }
    }
    for (auto& [group, result] : best) {
      result.method += " (best)";
      result.is_copy = true;
      results.push_back(std::move(result));
    }
  }
}

}  // namespace seqloop::experiment
