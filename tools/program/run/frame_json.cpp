// SPDX-License-Identifier: MIT
#include "program/run/frame_json.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "program/process/milliseconds.hpp"

namespace seqloop::program {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN and no infinity.
template <class Number>
Json finite(Number value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

// What an answer says beside which frame it is about, and its status.
constexpr std::array of_an_answer{"match",      "probability", "score",
                                  "uniqueness", "velocity",    "head"};

}  // namespace

Json answer_json(const Answer& answer) {
  Json json;
  json["frame"] = answer.frame;
  json["status"] = name(answer.gate);
  for (const char* key : of_an_answer) json[key] = nullptr;
  json["probability"] = finite(answer.probability);
  if (answer.match) {
    json["match"] = answer.match->frame();
    json["score"] = finite(answer.match->score);
    json["uniqueness"] = finite(answer.match->uniqueness);
    json["velocity"] = finite(answer.match->velocity);
    json["head"] = answer.match->head;
    if (answer.gate == Gate::not_unique && answer.match->runner_up) {
      json["runner_up"] = *answer.match->runner_up;
    }
  }
  return json;
}

std::vector<std::string_view> names(const Misses& missed) {
  std::vector<std::string_view> names;
  if (missed.age) names.emplace_back("age");
  if (missed.grab) names.emplace_back("grab");
  if (missed.describe) names.emplace_back("describe");
  if (missed.match) names.emplace_back("match");
  if (missed.total) names.emplace_back("total");
  return names;
}

Json frame_json(const ProcessedFrame& processed, const LoopState& state) {
  const FrameReport& report = processed.report;
  const bool came = report.gate != Gate::no_frame;
  const StageTimes& times = processed.times;
  Json json;
  json["frame"] = report.frame ? Json(*report.frame) : Json(nullptr);
  json["newest"] = came ? Json(report.newest) : Json(nullptr);
  json["time_s"] = came ? Json(processed.frame.time_s) : Json(nullptr);
  json["status"] = name(report.gate);
  for (const char* key : of_an_answer) json[key] = nullptr;
  json["answers"] = Json::array();
  json["now"] = nullptr;
  if (report.now) {
    json["now"] = {{"place", report.now->frame()},
                   {"probability", finite(report.now->probability)},
                   {"new_place", finite(report.now->new_place)}};
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
  add_answers(json, report.answers);
  return json;
}

void add_answers(Json& frame, std::span<const Answer> answers) {
  if (answers.empty()) return;
  Json& all = frame["answers"];
  for (const Answer& answer : answers) all.push_back(answer_json(answer));
  std::stable_sort(all.begin(), all.end(), [](const Json& one, const Json& other) {
    return one["frame"].get<std::uint64_t>() < other["frame"].get<std::uint64_t>();
  });
  for (const char* key : {"frame", "status"}) frame[key] = all.back()[key];
  for (const char* key : of_an_answer) frame[key] = all.back()[key];
}

void leave_out_answers(Json& frame) {
  for (const char* key : of_an_answer) frame.erase(key);
  frame.erase("answers");
}

}  // namespace seqloop::program
