// SPDX-License-Identifier: MIT
#include "program/watch/run_site.hpp"

#include <thread>
#include <utility>

#include "program/process/available_memory.hpp"
#include "program/process/build_info.hpp"
#include "program/process/json_text.hpp"
#include "program/watch/metrics.hpp"
#include "program/watch/page_files.hpp"
#include "program/watch/query.hpp"
#include "program/watch/take.hpp"

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr auto between_events = 100ms;
constexpr auto between_pairs = 1500ms;
constexpr auto between_lists = 6s;
constexpr auto still_looks = 3s;  // who has not asked for so long has gone

http::Reply json_reply(const Json& json, int status = 200) {
  // Names of files may be no UTF-8.
  return {status, "application/json", json_text(json) + '\n'};
}

http::Reply fault(int status, std::string_view why) { return json_reply({{"error", why}}, status); }

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void RunSite::add_place(const Image& image, std::uint64_t number) {
  const auto small = std::make_unique<SmallPicture>();
  const std::scoped_lock lock(mutex_);
  if (shrink(image, number, *small)) places_.add(*small);
}

void RunSite::keep_in(LastingMap& map) {
  const std::scoped_lock lock(mutex_);
  map_ = &map;
  Json& sessions = view_.run()["sessions"] = Json::array();
  for (const LastingMap::Session& session : map.sessions()) {
    sessions.push_back({{"name", session.name}, {"first", session.first}});
  }
}

bool RunSite::looked_at() const { return Clock::now() - looked_at_ < still_looks; }

void RunSite::take() {
  // Asked first: where it is there, the frames below are all, and none of them undoes it.
  const RunCounts* last_counts = watch_->last_counts();
  program::take(
      *watch_, frames_, [this](const Snapshot& snapshot) { view_.take(snapshot, seconds_now()); },
      [this](const Answer& answer) {
        view_.take(answer);
        return true;
      },
      [this](const OtherLoop& loop) {
        view_.take(loop);
        return true;
      });
  if (last_counts != nullptr) view_.take(*last_counts);
  if (watch_->wishes.pause.load(std::memory_order_relaxed)) view_.pause(seconds_now());
  // It goes on while the loop is paused, and tells of no frame.
  if (map_ != nullptr) view_.take_saved(map_->saved());
  watch_->wishes.pictures.store(looked_at(), std::memory_order_relaxed);
}

void RunSite::choose_shown() {
  const auto now = Clock::now();
  if (now - shown_.pair_at >= between_pairs || ended_) {
    shown_.pair_at = now;
    const std::optional<Answer>& answer = view_.last_answer();
    const bool known = answer && answer->match && answer->gate != Gate::new_place;
    // Where no place is known, what the camera sees now.
    shown_.frame = known              ? Json(answer->frame)
                   : frames_.newest() ? Json(*frames_.newest())
                                      : Json();
    shown_.place = known ? Json(answer->match->frame()) : Json();
    const bool two = known && answer->gate == Gate::not_unique && answer->match->runner_up;
    shown_.runner_up = two ? Json(*answer->match->runner_up) : Json();
  }
  if (now - shown_.loops_at >= between_lists || ended_) {
    shown_.loops_at = now;
    shown_.loops = view_.loop_count();
  }
}

void RunSite::tell() {
  choose_shown();
  Json json = view_.event(told_frames_, told_answers_);
  json["status"] = status();
  event_ = std::make_shared<const std::string>("data: " + json_text(json) + "\n\n");
  ++event_number_;
  told_frames_ = view_.frames_seen();
  told_answers_ = view_.answers_seen();
  told_at_ = Clock::now();
  told_.notify_all();
}

void RunSite::follow() {
  const std::scoped_lock lock(mutex_);
  take();
  if (!looked_at()) {
    told_frames_ = view_.frames_seen();
    told_answers_ = view_.answers_seen();
    return;
  }
  const auto since = Clock::now() - told_at_;
  const bool news = told_frames_ != view_.frames_seen() || told_answers_ != view_.answers_seen();
  // Without news the times go on all the same: for how long no frame has come.
  if (since >= (news ? Clock::duration(between_events) : Clock::duration(1s))) tell();
}

void RunSite::end() {
  {
    const std::scoped_lock lock(mutex_);
    take();
    ended_ = true;
    tell();
    if (!looked_at()) return;
  }
  std::this_thread::sleep_for(300ms);  // for the last word to be sent
}

std::shared_ptr<const std::string> RunSite::event(std::uint64_t& last) {
  std::unique_lock lock(mutex_);
  looked_at_ = Clock::now();
  if (last == 0) {
    // The first word says where this client comes in; what was before is its history.
    last = event_number_;
    choose_shown();
    Json json = view_.event(told_frames_, told_answers_);
    json["status"] = status();
    return std::make_shared<const std::string>("retry: 2000\ndata: " + json_text(json) + "\n\n");
  }
  told_.wait_for(lock, 1s, [&] { return event_number_ > last; });
  looked_at_ = Clock::now();
  if (event_number_ == last) return nullptr;
  last = event_number_;
  return event_;
}

std::string RunSite::trouble() const {
  if (ended_) return "the run has ended";
  return watch_->wishes.pause ? "" : view_.trouble(seconds_now());
}

Json RunSite::status() const {
  Json json;
  json["id"] = id_;
  const bool paused = watch_->wishes.pause.load(std::memory_order_relaxed);
  json["state"] = ended_ ? "ended" : paused ? "paused" : "running";
  json.update(view_.status());
  if (const float least = watch_->wishes.min_probability.load(std::memory_order_relaxed);
      least > 0.0F)
    json["run"]["decision"]["min_probability"] = least;
  json["map"]["memory_used"] = resident_memory();
  const std::string why = trouble();
  json["health"] = {{"ok", why.empty()}, {"why", why}};
  json["shown"] = {{"frame", shown_.frame},
                   {"place", shown_.place},
                   {"runner_up", shown_.runner_up},
                   {"loops", shown_.loops}};
  json["newest_picture"] = frames_.newest() ? Json(*frames_.newest()) : Json(nullptr);
  json["picture_of_every"] = frames_.every();
  json["unseen"] = watch_->unseen();
  return json;
}

http::Reply RunSite::metrics() const {
  const http::ServerCounts counts = server_ != nullptr ? server_->counts() : http::ServerCounts{};
  MonitorFacts facts;
  facts.version = version_line();
  Json run = view_.status()["run"];
  facts.places_room = run.value("places", std::uint64_t{0});
  facts.memory_planned = run.value("memory_planned", std::uint64_t{0});
  facts.memory_used = resident_memory();
  facts.unseen = watch_->unseen();
  facts.connections = counts.connections;
  facts.bytes_sent = counts.bytes_sent;
  facts.healthy = trouble().empty();
  return {200, "text/plain; version=0.0.4; charset=utf-8", program::metrics(view_.newest(), facts)};
}

http::Reply RunSite::around(std::string_view query) const {
  Json json;
  for (const std::string_view name : {"place", "runner_up"}) {
    const auto place = number_in(query, name);
    if (!place || !saved_places_) continue;
    try {
      json[name] = saved_places_->around(*place);
    } catch (const SetupError& error) {
      return fault(404, error.what());
    }
  }
  const std::scoped_lock lock(mutex_);
  for (const std::string_view name : {"frame", "place", "runner_up"}) {
    const auto number = number_in(query, name);
    if (!number || json.contains(name)) continue;
    json[name] = (own_places_ || name == "frame" ? frames_ : places_).around(*number);
  }
  return json_reply(json);
}

http::Reply RunSite::picture(std::string_view query) {
  const auto number = number_in(query, "number");
  const bool of_place = value_in(query, "of") == "place";
  if (!number || (!of_place && value_in(query, "of") != "frame"))
    return fault(400, "of=frame or of=place, and number=N, are wanted");
  if (of_place && saved_places_) {
    try {
      std::string file = saved_places_->jpeg(*number);
      if (file.empty()) return fault(404, "no picture of it is kept");
      return {200, "image/jpeg", std::move(file)};
    } catch (const SetupError& error) {
      return fault(404, error.what());
    }
  }
  const PictureStore& store = of_place && !own_places_ ? places_ : frames_;
  for (int tries = 0; tries < 60; ++tries) {
    {
      const std::scoped_lock lock(mutex_);
      const auto known = encoded_.find({of_place && !own_places_, *number});
      if (known != encoded_.end()) return {200, "image/jpeg", known->second};
      const auto now = Clock::now();
      while (!encoded_at_.empty() && now - encoded_at_.front() > 1s) encoded_at_.pop_front();
      if (encoded_at_.size() < pictures_a_second) {
        std::string file = store.jpeg(*number);
        if (file.empty()) return fault(404, "no picture of it is kept");
        encoded_at_.push_back(now);
        constexpr std::size_t most_encoded = 400;
        if (encoded_.size() >= most_encoded) encoded_.clear();
        encoded_.emplace(std::pair{of_place && !own_places_, *number}, file);
        return {200, "image/jpeg", std::move(file)};
      }
    }
    std::this_thread::sleep_for(50ms);
  }
  return fault(503, "too many pictures are asked for; ask again");
}

http::Reply RunSite::get(std::string_view path, std::string_view query) {
  const PageFiles page = page_files();
  if (path == "/") return {200, "text/html; charset=utf-8", std::string(page.html)};
  if (path == "/style.css") return {200, "text/css; charset=utf-8", std::string(page.style)};
  if (path == "/page.js") return {200, "text/javascript; charset=utf-8", std::string(page.script)};
  if (path == "/api/picture") return picture(query);
  if (path == "/api/pictures") return around(query);
  const std::scoped_lock lock(mutex_);
  if (path == "/healthz") {
    const std::string why = trouble();
    return {why.empty() ? 200 : 503, "text/plain; charset=utf-8",
            (why.empty() ? "ok" : why) + "\n"};
  }
  if (path == "/metrics") return metrics();
  if (path == "/api/status") return json_reply(status());
  if (path == "/api/history") return json_reply(view_.history());
  if (path == "/api/marks") return json_reply(view_.marks());
  if (path == "/api/truth.csv") return {200, "text/csv; charset=utf-8", view_.truth_csv()};
  if (path == "/api/loops") {
    for (const std::string_view name : {"first", "count"}) {
      if (!value_in(query, name).empty() && !number_in(query, name))
        return fault(400, "first and count are whole numbers, 0 or more");
    }
    const std::uint64_t count = number_in(query, "count").value_or(most_loops_at_once);
    return json_reply(
        view_.loops(static_cast<std::size_t>(number_in(query, "first").value_or(0)),
                    static_cast<std::size_t>(std::min<std::uint64_t>(count, most_loops_at_once))));
  }
  return fault(404, "there is no such page");
}

http::Reply RunSite::set_threshold(const Json& wish) {
  const Json run = view_.status()["run"];
  if (run.value("/decision/by"_json_pointer, "") != "probability")
    return fault(409, "this run does not decide by probability");
  const double wanted = wish.contains("min_probability") && wish["min_probability"].is_number()
                            ? wish["min_probability"].get<double>()
                            : 0.0;
  // What the loop is told: there, 0 is no wish.
  const auto least = static_cast<float>(wanted);
  if (!(least > 0.0F && wanted <= 1.0))
    return fault(400, "min_probability is above 0, and 1 at most");
  watch_->wishes.min_probability.store(least, std::memory_order_relaxed);
  return json_reply({{"min_probability", wanted}});
}

http::Reply RunSite::control(const Json& wish) {
  const std::string what = wish.value("do", "");
  Wishes& wishes = watch_->wishes;
  if (what == "pause" || what == "resume") {
    wishes.pause.store(what == "pause", std::memory_order_relaxed);
  } else if (what == "stop") {
    wishes.stop.store(true, std::memory_order_relaxed);
  } else if (what == "save") {
    if (map_ == nullptr) return fault(409, "this run keeps no map in a file");
    if (!map_->save_now()) return fault(409, "the map is only read, or the run has ended");
  } else if (what == "threshold") {
    return set_threshold(wish);
  } else if (what == "mark") {
    const std::string name = wish.value("name", "");
    if (name.empty()) return fault(400, "name is what the mark is called");
    if (!view_.mark(name)) return fault(409, "there is no frame yet, or no room for more marks");
  } else {
    return fault(400, "do is pause, resume, stop, save, threshold or mark");
  }
  return json_reply({{"done", what}});
}

http::Reply RunSite::judge(const Json& wish) {
  const std::string word = wish.value("verdict", "");
  if (word != "accepted" && word != "rejected" && word != "none")
    return fault(400, "verdict is accepted, rejected or none");
  const Verdict verdict = word == "accepted"   ? Verdict::accepted
                          : word == "rejected" ? Verdict::rejected
                                               : Verdict::none;
  if (!wish.contains("loop") || !wish["loop"].is_number_unsigned())
    return fault(400, "loop is the number of a loop");
  const auto number = wish["loop"].get<std::size_t>();
  if (number < view_.loop_count()) {
    const Loop& loop = view_.loop_list()[number];
    if (wish.value("frame", loop.frame) != loop.frame ||
        wish.value("match", loop.match) != loop.match)
      return fault(409, "that number is another loop's in this run; load the page anew");
  }
  if (!view_.judge(number, verdict)) {
    return fault(404, number < view_.loop_count() ? "it is a loop with another robot's place"
                                                  : "there is no such loop");
  }
  if (map_ != nullptr) {
    const Loop& loop = view_.loop_list()[number];
    map_->judge(loop.frame, loop.match, verdict);
  }
  return json_reply({{"loop", wish["loop"]}, {"verdict", word}});
}

http::Reply RunSite::post(std::string_view path, std::string_view body) {
  const Json wish = Json::parse(body, nullptr, false);
  if (!wish.is_object()) return fault(400, "the body is no JSON object");
  const std::scoped_lock lock(mutex_);
  try {
    if (path == "/api/control") return control(wish);
    if (path == "/api/verdict") return judge(wish);
  } catch (const Json::exception&) {
    return fault(400, "a value is of another kind than it must be");
  }
  return fault(404, "there is nothing to be changed by that name");
}

}  // namespace seqloop::program
