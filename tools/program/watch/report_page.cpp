// SPDX-License-Identifier: MIT
#include "program/watch/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "program/process/interruption.hpp"
#include "program/process/json_text.hpp"
#include "program/watch/page_files.hpp"
#include "program/watch/run_view.hpp"

namespace seqloop::program {
namespace {

using Json = nlohmann::ordered_json;

template <class Number>
Number number(const Json& json, const char* key, Number otherwise) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? otherwise : found->get<Number>();
}

Nanoseconds duration(const Json& times, const char* stage) {
  return std::chrono::duration_cast<Nanoseconds>(std::chrono::duration<double, std::milli>(
      std::clamp(times.at(stage).get<double>(), 0.0, 1e12)));
}

Answer answer_of(const Json& json) {
  constexpr float undefined = std::numeric_limits<float>::quiet_NaN();
  Answer answer;
  answer.frame = json.at("frame").get<std::uint64_t>();
  answer.gate = gate_of(json.at("status").get<std::string>()).value();
  answer.probability = number(json, "probability", undefined);
  if (json.at("match").is_null()) return answer;
  Match& match = answer.match.emplace();
  match.place = json.at("match").get<std::uint64_t>();
  match.score = number(json, "score", undefined);
  match.uniqueness = number(json, "uniqueness", undefined);
  match.velocity = number(json, "velocity", std::nan(""));
  match.head = number(json, "head", std::uint64_t{0});
  return answer;
}

/// Counts a line, and what it says of its frame.
class Lines {
 public:
  explicit Lines(RunView& view) : view_(&view), snapshot_(std::make_unique<Snapshot>()) {}

  void take(const Json& line) {
    RunCounts& counts = snapshot_->counts;
    const Json& answers = line.at("answers");
    for (const Json& answer : answers) ++counts.at[index(answer_of(answer).gate)];
    if (line.at("status") == "no_frame") ++counts.at[index(Gate::no_frame)];
    if (answers.empty() && line.at("status") == "frame_error")
      ++counts.at[index(Gate::frame_error)];
    if (!line.at("newest").is_null()) take_frame(line);
    // After its frame, whose time may be theirs.
    for (const Json& answer : answers) view_->take(answer_of(answer));
  }

  void end() {
    RunCounts& counts = snapshot_->counts;
    const auto answered = [&](std::size_t gate) {
      return gate == index(Gate::no_frame) ? 0 : counts.at[gate];
    };
    std::uint64_t sum = 0;
    for (std::size_t gate = 0; gate < gates; ++gate) sum += answered(gate);
    counts.at[index(Gate::warming_up)] += counts.frames - std::min(counts.frames, sum);
    // Once more, for its counts alone.
    snapshot_->frame.report.gate = Gate::no_frame;
    view_->take(*snapshot_, 0.0);
  }

  [[nodiscard]] std::uint64_t frames() const { return snapshot_->counts.frames; }

 private:
  static std::size_t index(Gate gate) { return static_cast<std::size_t>(gate); }

  void take_frame(const Json& line) {
    RunCounts& counts = snapshot_->counts;
    FrameReport& report = snapshot_->frame.report;
    const auto newest = line.at("newest").get<std::uint64_t>();
    if (counts.frames > 0 && newest <= report.newest) throw std::invalid_argument("another run");
    ++counts.frames;
    report = {};
    report.newest = newest;
    report.gate = gate_of(line.at("status").get<std::string>()).value_or(Gate::waiting);
    report.k = line.at("k").get<std::size_t>();
    report.full_search = line.at("full_search").get<bool>();
    report.map_full = line.at("map_full").get<bool>();
    report.work.candidates = line.at("candidates").get<std::uint64_t>();
    report.work.distances = line.at("distances").get<std::uint64_t>();
    Frame& frame = snapshot_->frame.frame;
    frame.time_s = line.at("time_s").get<double>();
    frame.dropped = line.at("dropped").get<std::uint64_t>();
    frame.lost = line.at("lost").get<std::uint64_t>();
    frame.sequence = number(line, "sequence", std::uint32_t{0});
    const Json& times = line.at("latency_ms");
    snapshot_->frame.times = {{},
                              duration(times, "grab"),
                              duration(times, "describe"),
                              duration(times, "match"),
                              duration(times, "total")};
    snapshot_->state.missed.total = line.at("deadline_missed").get<bool>();
    snapshot_->state.overloaded = line.at("overloaded").get<bool>();
    if (snapshot_->state.missed.total) ++counts.misses;
    if (snapshot_->state.overloaded) ++counts.overloaded;
    counts.dropped += frame.dropped;
    counts.lost += frame.lost;
    view_->take(*snapshot_, frame.time_s);
  }

  RunView* view_;
  std::unique_ptr<Snapshot> snapshot_;
};

/// JSON that ends no script element, whatever the names in it.
std::string in_a_page(const Json& json) {
  std::string text;
  for (const char c : json_text(json)) {
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  }
  return text;
}

void replace(std::string& text, std::string_view part, const std::string& by) {
  const std::size_t at = text.find(part);
  if (at != std::string::npos) text.replace(at, part.size(), by);
}

}  // namespace

std::string report_page(std::istream& lines, const std::string& name, Json run) {
  const Json summed_up = run.is_object() ? run.value("frames", Json()) : Json();
  RunView view(std::move(run));
  Lines taken(view);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    stop_if_interrupted();
    ++number;
    try {
      taken.take(Json::parse(line));
    } catch (const std::exception&) {  // JSON's, and a status that there is not
      throw SetupError({fmt::format("{}:{}", name, number),
                        "is no line that `seqloop run` writes there",
                        "give what `run --out` wrote"});
    }
  }
  if (number == 0) throw SetupError({name, "is empty", "give what `run --out` wrote"});
  if (!summed_up.is_null() && summed_up != taken.frames()) {
    throw SetupError({"summary",
                      fmt::format("it is of a run of {} frames, and {} has {}",
                                  json_text(summed_up), name, taken.frames()),
                      "give the summary of that run, or leave --summary out"});
  }
  taken.end();
  Json data;
  data["status"] = view.status();
  data["status"]["state"] = "ended";
  data["status"]["health"] = {{"ok", true}, {"why", ""}};
  data["status"]["unseen"] = 0;
  data["history"] = view.history();
  // As many as a page holds easily: 10 MB of them.
  constexpr std::size_t most_loops = 50'000;
  data["loops"] = view.loops(0, most_loops)["loops"];
  data["status"]["loops"]["listed"] = data["loops"].size();

  const PageFiles files = page_files();
  std::string page(files.html);
  replace(page, "<link rel=\"stylesheet\" href=\"/style.css\">\n",
          "<style>" + std::string(files.style) + "</style>\n");
  replace(page, "<script src=\"/page.js\" defer></script>\n",
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
          "'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\">\n");
  replace(page, "</body>",
          "<script type=\"application/json\" id=\"report\">" + in_a_page(data) +
              "</script>\n<script>" + std::string(files.script) + "</script>\n</body>");
  return page;
}

}  // namespace seqloop::program
