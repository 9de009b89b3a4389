#include "seqloop/frame_json.hpp"

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

std::string frame_json(const ProcessedFrame& processed, bool deadline_missed) {
  const FrameReport& report = processed.report;
  const StageTimes& times = processed.times;
  Json json;
  json["frame"] = report.frame ? Json(*report.frame) : Json(nullptr);
  json["newest"] = processed.frame.index;
  json["time_s"] = processed.frame.time_s;
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
  json["deadline_missed"] = deadline_missed;
  json["dropped"] = 0;  // this loop waits for its source and drops nothing
  json["latency_ms"] = {{"grab", milliseconds(times.grab)},
                        {"describe", milliseconds(times.describe)},
                        {"match", milliseconds(times.match)},
                        {"total", milliseconds(times.total)}};
  json["late_ms"] = milliseconds(times.late);
  if (!processed.fault.empty()) json["fault"] = processed.fault;
  // A file name in a message may be no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace seqloop::program
