// SPDX-License-Identifier: MIT
#include "program/run/frame_json.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

namespace seqloop::program {
namespace {

using Json = nlohmann::ordered_json;

double milliseconds(Nanoseconds duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

/// JSON has no NaN and no infinity.
Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

std::vector<std::string_view> names(const Misses& missed) {
  std::vector<std::string_view> names;
  if (missed.age) names.emplace_back("age");
  if (missed.grab) names.emplace_back("grab");
  if (missed.describe) names.emplace_back("describe");
  if (missed.match) names.emplace_back("match");
  if (missed.total) names.emplace_back("total");
  return names;
}

std::string frame_json(const ProcessedFrame& processed, const LoopState& state) {
  const FrameReport& report = processed.report;
  const bool came = report.gate != Gate::no_frame;
  const StageTimes& times = processed.times;
  Json json;
  json["frame"] = report.frame ? Json(*report.frame) : Json(nullptr);
  json["newest"] = came ? Json(report.newest) : Json(nullptr);
  json["time_s"] = came ? Json(processed.frame.time_s) : Json(nullptr);
  json["status"] = name(report.gate);
  for (const char* key : {"match", "score", "uniqueness", "velocity", "head"}) json[key] = nullptr;
  if (report.match) {
    json["match"] = report.match->place;
    json["score"] = finite(static_cast<double>(report.match->score));
    json["uniqueness"] = finite(static_cast<double>(report.match->uniqueness));
    json["velocity"] = finite(report.match->velocity);
    json["head"] = report.match->head;
  }
  json["k"] = report.k;
  json["candidates"] = report.work.candidates;
  json["distances"] = report.work.distances;
  json["full_search"] = report.full_search;
  json["map_full"] = report.map_full;
  json["deadline_missed"] = state.missed.any();
  if (state.missed.any()) json["missed"] = names(state.missed);
  json["overloaded"] = state.overloaded;
  json["dropped"] = processed.frame.dropped;
  json["lost"] = processed.frame.lost;
  json["sequence"] = processed.frame.sequence;
  json["latency_ms"] = {{"grab", milliseconds(times.grab)},
                        {"describe", milliseconds(times.describe)},
                        {"match", milliseconds(times.match)},
                        {"total", milliseconds(times.total)}};
  json["age_ms"] = milliseconds(times.age);
  if (!processed.frame.remark.empty()) json["remark"] = processed.frame.remark;
  if (!processed.fault.empty()) json["fault"] = processed.fault;
  // A file name in a message may be no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace seqloop::program
