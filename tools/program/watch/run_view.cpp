// SPDX-License-Identifier: MIT
#include "program/watch/run_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "program/process/milliseconds.hpp"
#include "program/process/utf8.hpp"
#include "program/run/frame_json.hpp"

namespace seqloop::program {
namespace {

using Json = nlohmann::ordered_json;

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Rounded: it is sent often, and nobody sees more.
double thousandths(double value) { return std::round(value * 1e3) / 1e3; }

Json frame_row(const Snapshot& shown) {
  const StageTimes& times = shown.frame.times;
  Json row = Json::array({shown.frame.report.newest});
  for (const Nanoseconds took : {times.grab, times.describe, times.match, times.total}) {
    row.push_back(thousandths(milliseconds(took)));
  }
  row.push_back(shown.state.missed.any() ? 1 : 0);
  return row;
}

const char* word(Verdict verdict) { return verdict == Verdict::accepted ? "accepted" : "rejected"; }

constexpr std::size_t most_times = 4096;    // of frames whose answers may still come
constexpr std::size_t most_recent = 2'000;  // answers that are sent as they come

}  // namespace

void RunView::take(const Snapshot& snapshot, double now_s) {
  newest_ = snapshot;
  note_trouble(snapshot);
  if (!frame_at_s_) frame_at_s_ = now_s;
  if (snapshot.frame.report.gate == Gate::no_frame) return;
  frame_at_s_ = now_s;
  if (!snapshot.state.overloaded) over_since_s_.reset();
  if (snapshot.state.overloaded && !over_since_s_) over_since_s_ = now_s;
  const StageTimes& times = snapshot.frame.times;
  times_[0].add(times.grab);
  times_[1].add(times.describe);
  times_[2].add(times.match);
  times_[3].add(times.total);
  frames_.push_back(snapshot);
  if (frames_.size() > most_frames) frames_.pop_front();
  times_s_.emplace_back(snapshot.frame.report.newest, snapshot.frame.frame.time_s);
  if (times_s_.size() > most_times) times_s_.pop_front();
  ++frames_seen_;
}

void RunView::note_trouble(const Snapshot& snapshot) {
  const std::string_view text =
      snapshot.fault.view().empty() ? snapshot.remark.view() : snapshot.fault.view();
  if (text.empty()) return;
  const FrameReport& report = snapshot.frame.report;
  const bool silent = report.gate == Gate::no_frame;
  // The words of a silence count its seconds: it is one trouble all the same.
  const bool goes_on = !troubles_.empty() && troubles_.back().frame.has_value() != silent &&
                       (silent || troubles_.back().text == text);
  if (!goes_on) {
    troubles_.emplace_back();
    if (troubles_.size() > most_troubles) troubles_.pop_front();
  }
  Trouble& trouble = troubles_.back();
  trouble.text = text;
  if (!silent) trouble.frame = report.newest;
  ++trouble.times;
}

void RunView::take(const Answer& answer) {
  const Shown shown{answers_seen_++, answer};
  last_answer_ = answer;
  recent_.push_back(shown);
  if (recent_.size() > most_recent) recent_.pop_front();
  if (shown.number % every_ == 0) thinned_.push_back(shown);
  if (thinned_.size() > most_answers) {
    every_ *= 2;
    std::erase_if(thinned_, [this](const Shown& one) { return one.number % every_ != 0; });
  }
  if (answer.gate != Gate::match || !answer.match) return;
  last_match_ = answer;
  ++loops_seen_;
  if (loop_list_.size() == most_loops) return;
  loop_list_.push_back({answer.frame, answer.match->frame(), time_of(answer.frame),
                        answer.probability, answer.match->uniqueness, Verdict::none, std::nullopt});
}

void RunView::take(const OtherLoop& loop) {
  ++loops_of_others_;
  ++loops_seen_;
  if (loop_list_.size() == most_loops) return;
  const std::pair<std::string, std::string> whose(loop.robot.view(), loop.session.view());
  const auto known = std::ranges::find(others_, whose);
  const auto other = static_cast<std::uint32_t>(known - others_.begin());
  if (known == others_.end()) others_.push_back(whose);
  const Answer& answer = loop.answer;
  loop_list_.push_back({answer.frame, answer.match->place, time_of(answer.frame),
                        answer.probability, answer.match->uniqueness, Verdict::none, other});
}

double RunView::time_of(std::uint64_t frame) const {
  const auto found =
      std::ranges::lower_bound(times_s_, frame, {}, [](const auto& one) { return one.first; });
  return found == times_s_.end() || found->first != frame ? std::nan("") : found->second;
}

void RunView::pause(double now_s) {
  if (frame_at_s_) frame_at_s_ = now_s;
  over_since_s_.reset();
}

std::string RunView::trouble(double now_s) const {
  if (frame_at_s_ && now_s - *frame_at_s_ > patience_s) {
    return fmt::format("no frame for {:.0f} seconds", now_s - *frame_at_s_);
  }
  if (over_since_s_ && now_s - *over_since_s_ > patience_s) {
    return fmt::format("over the budget for {:.0f} seconds", now_s - *over_since_s_);
  }
  return {};
}

Json RunView::stages() const {
  Json json = Json::object();
  for (std::size_t i = 0; i < stage_names.size(); ++i) {
    json[stage_names[i]] = {{"p50_ms", thousandths(milliseconds(times_[i].quantile(.5)))},
                            {"p99_ms", thousandths(milliseconds(times_[i].quantile(.99)))},
                            {"max_ms", thousandths(milliseconds(times_[i].maximum()))}};
  }
  return json;
}

Json RunView::status() const {
  const RunCounts& counts = newest_.counts;
  Json json;
  json["run"] = run_;
  ProcessedFrame frame = newest_.frame;
  frame.fault = newest_.fault.view();
  frame.frame.remark = newest_.remark.view();
  json["frame"] = frames_seen_ > 0 ? frame_json(frame, newest_.state) : Json(nullptr);
  if (frames_seen_ > 0) leave_out_answers(json["frame"]);
  json["answer"] = last_answer_ ? answer_json(*last_answer_) : Json(nullptr);
  json["last_match"] = last_match_ ? answer_json(*last_match_) : Json(nullptr);
  Json& counted = json["counts"];
  counted["frames"] = counts.frames;
  for (std::size_t gate = 0; gate < gates; ++gate) {
    counted["gates"][std::string(name(static_cast<Gate>(gate)))] = counts.at[gate];
  }
  counted["misses"] = counts.misses;
  counted["dropped"] = counts.dropped;
  counted["lost"] = counts.lost;
  counted["overloaded"] = counts.overloaded;
  json["stages"] = stages();
  json["map"] = {{"places", newest_.map.places}, {"scanned", newest_.frame.report.work.scanned}};
  if (run_.contains("sessions")) json["map"]["saved"] = newest_.map.saved;
  json["troubles"] = Json::array();
  for (const Trouble& trouble : troubles_) {
    json["troubles"].push_back({{"frame", trouble.frame ? Json(*trouble.frame) : Json(nullptr)},
                                {"times", trouble.times},
                                {"text", trouble.text}});
  }
  json["loops"] = {{"count", loops_seen_},
                   {"listed", loop_list_.size()},
                   {"rejected", std::ranges::count(loop_list_, Verdict::rejected, &Loop::verdict)}};
  if (newest_.map.of_others) {
    json["fleet"] = {{"places", *newest_.map.of_others}, {"loops", loops_of_others_}};
  }
  json["marks"] = marks_.size();
  return json;
}

/// `[number, frame, status, match, probability]`, the status as its number among the gates.
Json RunView::row(const Shown& shown) {
  const Answer& answer = shown.answer;
  return {shown.number, answer.frame, static_cast<int>(answer.gate),
          answer.match ? Json(answer.match->frame()) : Json(nullptr),
          finite(thousandths(static_cast<double>(answer.probability)))};
}

Json RunView::history() const {
  Json json;
  json["first_frame"] = frames_seen_ - frames_.size();
  json["frames"] = Json::array();
  for (const Snapshot& frame : frames_) json["frames"].push_back(frame_row(frame));
  json["answers"] = Json::array();
  for (const Shown& shown : thinned_) json["answers"].push_back(row(shown));
  for (const Shown& shown : recent_) {
    if (thinned_.empty() || shown.number > thinned_.back().number) {
      json["answers"].push_back(row(shown));
    }
  }
  return json;
}

Json RunView::event(std::uint64_t first_frame, std::uint64_t first_answer) const {
  const std::uint64_t oldest = frames_seen_ - frames_.size();
  Json json;
  json["first_frame"] = std::max(oldest, first_frame);
  json["frames"] = Json::array();
  for (std::uint64_t n = std::max(oldest, first_frame); n < frames_seen_; ++n) {
    json["frames"].push_back(frame_row(frames_[static_cast<std::size_t>(n - oldest)]));
  }
  json["answers"] = Json::array();
  const auto begin = std::ranges::lower_bound(recent_, first_answer, {}, &Shown::number);
  for (auto shown = begin; shown != recent_.end(); ++shown) json["answers"].push_back(row(*shown));
  return json;
}

Json RunView::loops(std::size_t first, std::size_t count) const {
  Json json;
  json["count"] = loop_list_.size();
  json["first"] = first;
  json["loops"] = Json::array();
  for (std::size_t i = first; i < loop_list_.size() && i - first < count; ++i) {
    const Loop& loop = loop_list_[i];
    json["loops"].push_back(
        {{"number", i},
         {"frame", loop.frame},
         {"match", loop.match},
         {"time_s", finite(loop.time_s)},
         {"probability", finite(static_cast<double>(loop.probability))},
         {"uniqueness", finite(static_cast<double>(loop.uniqueness))},
         {"verdict", loop.verdict == Verdict::none ? Json(nullptr) : Json(word(loop.verdict))}});
    if (!loop.other) continue;
    json["loops"].back()["robot"] = others_[*loop.other].first;
    json["loops"].back()["session"] = others_[*loop.other].second;
  }
  return json;
}

Json RunView::marks() const {
  Json json = Json::array();
  for (const Mark& mark : marks_) json.push_back({{"frame", mark.frame}, {"name", mark.name}});
  return json;
}

std::string RunView::truth_csv() const {
  std::string csv = "query,reference\n";
  for (const Loop& loop : loop_list_) {
    if (loop.verdict == Verdict::accepted) csv += fmt::format("{},{}\n", loop.frame, loop.match);
  }
  return csv;
}

bool RunView::judge(std::size_t loop, Verdict verdict) {
  if (loop >= loop_list_.size() || loop_list_[loop].other) return false;
  loop_list_[loop].verdict = verdict;
  return true;
}

bool RunView::mark(std::string_view name) {
  if (marks_.size() == most_marks || frames_seen_ == 0) return false;
  name = name.substr(0, most_name);
  while (!is_utf8(name)) name.remove_suffix(1);  // no character is cut in two
  marks_.push_back({newest_.frame.report.newest, std::string(name)});
  return true;
}

}  // namespace seqloop::program
