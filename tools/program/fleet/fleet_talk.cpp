// SPDX-License-Identifier: MIT
#include "program/fleet/fleet_talk.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "program/fleet/round_time.hpp"
#include "program/watch/background.hpp"

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;

constexpr auto patience_at_end = 1s;

// Places that wait for the loop; it takes 64 a frame.
constexpr std::size_t queued = 1024;

// Lines for a person that nobody has read yet.
constexpr std::size_t most_news = 64;

dds::FleetSession about_of(const FleetSettings& settings, const PlaceForm& form) {
  return {robot_name(settings),
          {},
          form.form,
          form.describer,
          static_cast<std::uint32_t>(form.descriptor_size),
          static_cast<std::uint32_t>(form.place_bytes)};
}

// A frame this far behind one whose answer is known has none.
constexpr std::uint64_t never_judged = 300;

// Of a message beside a descriptor, on the wire: with the headers of all layers.
constexpr std::size_t message_bytes = 200;

/// Thrown to stop reading a file.
struct Ending : std::exception {};

}  // namespace

FleetTalk::FleetTalk(const FleetSettings& settings, const dds::Participant& participant,
                     LastingMap& map)
    : map_(&map),
      learnt_(std::make_shared<Learnt>()),
      about_(about_of(settings, map.form())),
      earlier_(map.begun()),
      wire_(participant, settings.name, settings.places),
      others_(about_, earlier_, settings.places),
      heard_(queued, map.form().place_bytes),
      allowance_(settings.kbps),
      room_(settings.places),
      novel_(settings.novel),
      thread_([this] { work(); }) {
  map.follow([learnt = learnt_](std::int64_t began_ns, const SessionStatistics& its) {
    const std::scoped_lock lock(learnt->mutex);
    learnt->statistics = {began_ns,
                          its.frames,
                          {its.mean.begin(), its.mean.end()},
                          {its.variance.begin(), its.variance.end()}};
  });
}

FleetTalk::~FleetTalk() { end(); }

void FleetTalk::end() {
  ending_ = true;
  if (thread_.joinable()) thread_.join();
}

void FleetTalk::work() {
  become_background();
  try {
    tell_earlier();
  } catch (const Ending&) {
  } catch (const std::exception& error) {
    pass_on(std::string("earlier sessions are not told to other robots: ") + error.what());
  }
  while (!ending_) {
    tell_newest();
    tell_statistics(statistics_after_);
    tell_found();
    hear();
    wire_.wait(round_time);
  }
  const auto until = std::chrono::steady_clock::now() + patience_at_end;
  while (std::chrono::steady_clock::now() < until) {
    tell_newest();
    if (waiting_.empty()) break;
    wire_.wait(round_time);
  }
  tell_found();
  tell_statistics(1);
  const auto left = until - std::chrono::steady_clock::now();
  if (left > 0s && wire_.others() > 0) wire_.flush(left);
}

/// Of the sessions that the file had before this run, the newest: robots hear no more, and this
/// run's is one.
void FleetTalk::tell_earlier() {
  map_->read_saved(most_fleet_sessions - 1, [this](const SavedPlace& place) {
    if (std::ranges::find(earlier_, place.began_ns) == earlier_.end()) return;
    while (!tell(place)) {
      if (ending_) throw Ending();
      read_newest();
      hear();
      wire_.wait(round_time);
    }
    if (told_ % said_every != 0) return;
    read_newest();
    hear();
  });
}

/// What the drive has added since the last time. It waits here, not in the map, which could not
/// forget it.
void FleetTalk::read_newest() {
  map_->read_newest([this](const SavedPlace& place) {
    if (waiting_.size() == room_) {
      waiting_.pop_front();
      ++untold_;
    }
    if (running_.empty()) running_ = place.session;
    waiting_.push_back({place, {place.bytes.begin(), place.bytes.end()}});
    waiting_.back().place.session = {};
    waiting_.back().place.bytes = {};
  });
}

void FleetTalk::tell_newest() {
  read_newest();
  for (; !waiting_.empty(); waiting_.pop_front()) {
    const Waiting& next = waiting_.front();
    const std::optional<bool> novel = next.place.visits ? true : is_novel(next.place.frame);
    if (!novel) return;
    if (!*novel) {
      ++known_;
      continue;
    }
    SavedPlace whole = next.place;
    whole.session = running_;
    whole.bytes = next.bytes;
    if (!tell(whole)) return;
    if (whole.visits) continue;
    newest_told_ = {whole.began_ns, whole.frame};
    if (novel_) told_frames_.insert(whole.frame);
  }
}

/// @return whether a place is to be told; nothing as long as that is not known. Frames rise
std::optional<bool> FleetTalk::is_novel(std::uint64_t frame) {
  if (!novel_) return true;
  while (const Judged* const judged = judged_.front()) {
    loops_[judged->frame] = judged->loop;
    newest_judged_ = std::max(newest_judged_, judged->frame);
    if (!judged->loop) newest_novel_ = std::max(newest_novel_, judged->frame);
    judged_.pop();
  }
  // Not every frame becomes a place.
  loops_.erase(loops_.begin(), loops_.lower_bound(frame));
  const auto known = loops_.find(frame);
  if (known != loops_.end()) {
    const bool novel = !known->second;
    loops_.erase(known);
    return novel;
  }
  // Of a frame that never came nothing is said; and of those that close no loop it is in order.
  if (ending_ || newest_novel_ > frame || newest_judged_ > frame + never_judged) return true;
  return std::nullopt;
}

/// Places of this drive that are places of others, once they are told themselves.
void FleetTalk::tell_found() {
  while (const Found* const found = found_.front()) {
    if (!newest_told_ || found->frame > newest_told_->frame) return;
    if (novel_ && !told_frames_.contains(found->frame)) {
      found_.pop();
      continue;
    }
    const std::optional<dds::FleetVisit> visited = place_of(*found);
    if (visited) {
      if (!publish({newest_told_->session, found->frame, 0, {}, visited, {}}, nullptr)) return;
      if (found->own) linked_.insert(found->frame);
    }
    found_.pop();
  }
}

/// @return nothing where the place was not told
std::optional<dds::FleetVisit> FleetTalk::place_of(const Found& found) const {
  if (!found.own) {
    return dds::FleetVisit{others_.names(found.session).began_ns, found.session_frame};
  }
  const auto told = told_as_.find(*found.own);
  return told == told_as_.end() ? std::nullopt : std::optional(told->second);
}

/// By what the running session is standardised, once that many of its places are told.
void FleetTalk::tell_statistics(std::uint64_t places) {
  if (!newest_told_ || newest_told_->session != session_ || of_session_ < places) return;
  Statistics newest;
  {
    const std::scoped_lock lock(learnt_->mutex);
    newest = learnt_->statistics;
  }
  if (newest.frames == 0 || newest.began_ns != session_) return;
  dds::FleetPlace none{.session = session_, .frame = newest_told_->frame};
  none.statistics = {newest.frames, newest.mean, newest.variance};
  if (publish(none, nullptr)) statistics_after_ = 2 * of_session_;
}

/// @return false where others are too slow, or enough was told just now
bool FleetTalk::tell(const SavedPlace& place) {
  if (place.statistics) {
    dds::FleetPlace none{.session = place.began_ns};
    none.statistics = {place.statistics->frames, place.statistics->mean,
                       place.statistics->variance};
    return publish(none, nullptr);
  }
  if (place.visits) {
    if (newest_told_ && place.began_ns == newest_told_->session && linked_.erase(place.frame) > 0) {
      return true;
    }
    const auto visited = told_as_.find(*place.visits);
    // What has gone from the map was not told, or is not novel.
    if (visited == told_as_.end() || !told_as_.contains(place.number)) return true;
    return publish({place.began_ns, place.frame, 0, {}, visited->second, {}}, nullptr);
  }
  if (std::exchange(session_, place.began_ns) != place.began_ns) {
    of_session_ = 0;
    about_.name = place.session;
  }
  if (!publish({place.began_ns, place.frame, place.time_ns, place.bytes, {}, {}},
               of_session_ % said_every == 0 ? &about_ : nullptr)) {
    return false;
  }
  told_as_[place.number] = {place.began_ns, place.frame};
  ++told_;
  ++of_session_;
  return true;
}

bool FleetTalk::publish(const dds::FleetPlace& place, const dds::FleetSession* about) {
  if (!allowance_.left() || !wire_.publish(place, about)) return false;
  std::size_t bytes = place.bytes.size() + message_bytes;
  if (place.statistics) bytes += 2 * place.statistics->mean.size_bytes();
  allowance_.spend(bytes);
  return true;
}

/// Hears as much as the loop has room for; the rest waits in DDS.
void FleetTalk::hear() {
  const auto take = [this](const dds::FleetPlace& place, const dds::FleetSession* about) {
    // A keeper tells this drive again; and only a keeper wants statistics.
    if (newest_told_ && place.session == newest_told_->session) return;
    if (place.statistics) return;
    if (place.visit) {
      if (const auto same = others_.same_place(place)) {
        heard_.push({same->session, place.frame, {}, {{same->visited, place.visit->frame}}});
      } else if (!newest_told_ || place.visit->session != newest_told_->session) {
        others_.wait_for_places(place);
      }
    } else if (const auto session = others_.hear(place, about)) {
      heard_.push({*session, place.frame, place.bytes, {}});
    }
  };
  for (std::size_t i = 0; i < most_a_round && !heard_.full() && wire_.take(take); ++i) {
  }
  while (!heard_.full()) {
    const std::optional<dds::FleetPlace> visit = others_.next_visit();
    if (!visit) break;
    take(*visit, nullptr);
  }
  for (std::string& line : others_.news()) pass_on(std::move(line));
}

void FleetTalk::pass_on(std::string line) {
  const std::scoped_lock lock(mutex_);
  if (news_.size() < most_news) news_.push_back(std::move(line));
  has_news_.store(true, std::memory_order_release);
}

std::optional<std::string> FleetTalk::news() {
  if (!has_news_.load(std::memory_order_acquire)) return std::nullopt;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || news_.empty()) return std::nullopt;
  std::string line = std::move(news_.front());
  news_.pop_front();
  has_news_.store(!news_.empty(), std::memory_order_relaxed);
  return line;
}

FleetTalk::Counts FleetTalk::counts() {
  return {told_, known_, untold_ + waiting_.size(), others_.places(), others_.sessions()};
}

}  // namespace seqloop::program
