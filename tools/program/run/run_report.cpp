// SPDX-License-Identifier: MIT
#include "program/run/run_report.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "program/options/loop_options.hpp"
#include "program/process/build_info.hpp"
#include "program/process/json_text.hpp"
#include "program/process/milliseconds.hpp"

namespace seqloop::program {
namespace {

using Json = nlohmann::ordered_json;

Json stage_json(const LatencyHistogram& times) {
  Json json;
  json["p50_ms"] = milliseconds(times.quantile(0.5));
  json["p99_ms"] = milliseconds(times.quantile(0.99));
  json["p999_ms"] = milliseconds(times.quantile(0.999));
  json["max_ms"] = milliseconds(times.maximum());
  json["buckets"] = Json::array();
  for (std::size_t bucket = 0; bucket < LatencyHistogram::buckets; ++bucket) {
    const std::uint64_t count = times.count_in(bucket);
    if (count == 0) continue;
    json["buckets"].push_back({milliseconds(LatencyHistogram::longest_in(bucket)), count});
  }
  return json;
}

Json budget_json(const Budget& budget) {
  return {{"total", milliseconds(budget.total)},
          {"age", milliseconds(budget.age)},
          {"grab", milliseconds(budget.grab)},
          {"describe", milliseconds(budget.describe)},
          {"match", milliseconds(budget.match)}};
}

/// The number that is written as a float is: .99, and not .9900000095.
double as_written(float number) {
  const std::string text = fmt::format("{}", number);
  double same = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), same);
  return same;
}

Json decision_json(const RunConditions& conditions) {
  const MatcherConfig& config = conditions.config;
  if (config.decision == Decision::uniqueness) {
    return {{"by", "uniqueness"}, {"max_uniqueness", as_written(config.max_uniqueness)}};
  }
  Json json{{"by", "probability"},
            {"min_probability", as_written(config.min_probability)},
            {"patience", config.patience}};
  for (const ThresholdChange& change : conditions.changes) {
    json["changes"].push_back(
        {{"frame", change.frame}, {"min_probability", as_written(change.min_probability)}});
  }
  return json;
}

}  // namespace

Json conditions_json(const RunConditions& conditions) {
  Json json;
  json["conditions"] = condition_line();
  json["source"] = conditions.source.string();
  if (!conditions.reference.empty()) json["reference"] = conditions.reference.string();
  if (!conditions.map.empty()) json["map"] = conditions.map.string();
  json["capture"] = conditions.capture;
  json["method"] = conditions.method;
  json["ds"] = conditions.config.sequence_length;
  json["decision"] = decision_json(conditions);
  json["places"] = conditions.places;
  json["descriptor_size"] = conditions.descriptor_size;
  json["budget_ms"] = budget_json(conditions.budget);
  json["overload"] = {{"policy", name(conditions.overload.policy)},
                      {"every", conditions.overload.every},
                      {"after", conditions.overload.after},
                      {"recover", conditions.overload.recover}};
  return json;
}

std::string run_report(const RunSummary& summary, const RunConditions& conditions) {
  Json json = conditions_json(conditions);
  json["overload"]["times"] = conditions.overloads;
  json["overload"]["frames"] = summary.overloaded();
  json["frames"] = summary.frames();
  for (std::size_t gate = 0; gate < gates; ++gate) {
    json["gates"][std::string(name(static_cast<Gate>(gate)))] = summary.at(static_cast<Gate>(gate));
  }
  if (const auto& counts = summary.capture()) {
    json["captured"] = {{"grabbed", counts->delivered}, {"taken", summary.frames()},
                        {"dropped", counts->dropped},   {"failed", counts->failed},
                        {"lost", counts->lost},         {"silences", counts->silences}};
  }
  json["misses"] = summary.misses();
  for (const auto& [limit, frames] : summary.missed()) json["missed"][std::string(limit)] = frames;
  json["dropped"] = summary.dropped();
  json["lost"] = summary.lost();
  for (const StageRecord& stage : summary.stages()) {
    json["stages"][stage.name] = stage_json(stage.times);
  }
  json["page_faults"] = {{"minor", conditions.cost.minor_faults},
                         {"major", conditions.cost.major_faults}};
  return json_text(json, 2) + '\n';
}

}  // namespace seqloop::program
