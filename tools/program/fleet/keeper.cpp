// SPDX-License-Identifier: MIT
#include "program/fleet/keeper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "program/fleet/place_number.hpp"
#include "program/fleet/round_time.hpp"
#include "program/map/move_log.hpp"
#include "program/process/json_text.hpp"
#include "program/process/say.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

constexpr auto patience = 1s;

// Places that wait to be saved; more wait in DDS.
constexpr std::size_t most_waiting = 16'384;

// Links of a place, on average: what many robots tell is bounded.
constexpr std::size_t links_a_place = 8;

std::uint64_t number_of(std::int64_t session, std::uint64_t frame) {
  return place_number(static_cast<std::uint64_t>(session), frame);
}

}  // namespace

Keeper::Keeper(std::filesystem::path file, const FleetSettings& settings,
               const dds::Participant& participant, double save_every_s)
    : path_(std::move(file)),
      settings_(settings),
      save_every_(save_every_s),
      wire_(participant, settings.name, settings.places),
      saved_(std::chrono::steady_clock::now()) {
  std::error_code error;
  if (std::filesystem::file_size(path_, error) == 0 || error) {
    // Told with the first place, it would be too late: what robots tell would wait to the end.
    sqlite::check_nothing_is_left_of_another(path_);
    return;
  }
  file_ = sqlite::MapFile::open(path_, std::nullopt);
  // Killed before it had saved a place, a keeper leaves a file that is like the first robot's.
  if (file_->holds_nothing()) {
    file_.reset();
    return;
  }
  know_sessions();
}

/// Whether a map can have such places. What the first robot tells decides what all are like, and
/// anybody may tell anything.
bool Keeper::can_be_kept(const dds::FleetPlace& place, const dds::FleetSession& about) {
  if (about.place_bytes >= 1 && about.place_bytes <= sqlite::most_place_bytes) return true;
  if (!std::exchange(refusing_, true)) {
    const Others::Names names = Others::names_of(about, place.session);
    news_.push_back(
        fmt::format("robot '{}', session '{}': it says {} bytes a place, and a map has 1 to {}: "
                    "none is kept; look at what it runs",
                    names.robot, names.session, about.place_bytes, sqlite::most_place_bytes));
  }
  return false;
}

/// Makes the file, of the form that the first robot tells. @return whether the disk took it
bool Keeper::open(const dds::FleetSession& about) {
  try {
    file_ = sqlite::MapFile::open(path_, sqlite::MapForm{about.form, about.describer,
                                                         about.descriptor_size, about.place_bytes});
  } catch (const SetupError& error) {
    fail(error.what());
    return false;
  }
  know_sessions();
  return true;
}

/// Goes on where the file ends.
void Keeper::know_sessions() {
  const sqlite::MapForm& form = file_->form();
  const dds::FleetSession own{robot_name(settings_),
                              {},
                              form.form,
                              form.describer,
                              static_cast<std::uint32_t>(form.descriptor_size),
                              static_cast<std::uint32_t>(form.place_bytes)};
  std::map<std::int64_t, Others::Before> before;
  std::vector<std::int64_t> not_growing;
  for (const sqlite::SessionFacts& facts : file_->sessions()) {
    Session session;
    session.id = facts.id;
    session.frames = facts.frames;
    session.gone = true;
    if (facts.places == 0) session.untold = facts.frames;
    const Json kept = Json::parse(facts.settings, nullptr, false);
    session.grows = kept.is_object() && kept.contains("robot") && kept.contains("session");
    session.names = {session.grows ? kept.value("robot", "") : robot_name(settings_),
                     session.grows ? kept.value("session", "") : facts.name, facts.began_ns};
    if (!session.grows) not_growing.push_back(facts.began_ns);
    sessions_.push_back(std::move(session));
  }
  others_.emplace(own, not_growing, most_fleet_places);
  file_->read([&](const sqlite::PlaceBlock& block) {
    const auto session = std::ranges::find(sessions_, block.session, &Session::id);
    if (session == sessions_.end()) return;
    if (!session->grows) {
      for (const sqlite::PlaceRecord& record : block.records) {
        earlier_[record.number] = {session->names.began_ns, record.frame};
      }
      return;
    }
    Others::Before& its = before[block.session];
    if (its.places == 0) its.first_ns = block.records.front().time_ns;
    its.places += block.records.size();
    its.frame = block.records.back().frame;
    its.newest_ns = block.records.back().time_ns;
  });
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    const auto its = before.find(sessions_[i].id);
    if (its == before.end()) continue;
    others_->resume(sessions_[i].names, its->second);
    heard_as_.emplace_back(i);
  }
  file_->read_links([this](const sqlite::SavedLink& link) {
    if (link.place) links_.emplace(*link.place, link.other);
  });
}

void Keeper::round(const std::function<bool()>& stop) {
  tell(stop);
  hear();
  if (std::chrono::steady_clock::now() - saved_ >= save_every_) save();
  wire_.wait(round_time);
}

void Keeper::hear() {
  const auto hear = [this](const dds::FleetPlace& place, const dds::FleetSession* about) {
    this->hear(place, about);
  };
  const auto gone = [this](std::int64_t began) {
    for (Session& session : sessions_) session.gone |= session.names.began_ns == began;
  };
  for (std::size_t i = 0; i < most_a_round && waiting_ < most_waiting && !first_; ++i) {
    if (!wire_.take(hear, gone)) break;
  }
  if (!others_) return;
  while (waiting_ < most_waiting && !first_) {
    const std::optional<dds::FleetPlace> visit = others_->next_visit();
    if (!visit) break;
    this->hear(*visit, nullptr);
  }
  for (std::string& line : others_->news()) news_.push_back(std::move(line));
}

void Keeper::hear(const dds::FleetPlace& place, const dds::FleetSession* about) {
  const bool is_place = !place.visit && !place.statistics;
  if (is_place && place.frame >= frames_of_a_session) return;
  if (!file_) {
    if (is_place && about != nullptr && can_be_kept(place, *about)) begin({place, {}, *about, {}});
    return;
  }
  if (place.statistics) {
    const auto index = others_->statistics(place);
    if (!index) return;
    session(*index).statistics = {
        place.statistics->frames,
        {place.statistics->mean.begin(), place.statistics->mean.end()},
        {place.statistics->variance.begin(), place.statistics->variance.end()}};
    return;
  }
  if (place.visit) {
    const auto same = others_->same_place(place);
    if (!same) return others_->wait_for_places(place);
    if (links_.size() >= links_a_place * others_->places()) return;
    Session& own = session(same->session);
    const std::uint64_t number = number_of(own.id, place.frame);
    const std::uint64_t other = number_of(session(same->visited).id, place.visit->frame);
    if (!links_.emplace(number, other).second) return;
    own.links.push_back({own.id, place.frame, number, other, PlaceMap::likely});
    ++waiting_;
    return;
  }
  const auto index = others_->hear(place, about);
  if (!index) return;
  if (*index < heard_as_.size() && heard_as_[*index]) return keep(place, session(*index));
  begin({place, {}, {}, index});
}

/// Where the disk is full, this waits, and nothing else is heard: it waits in DDS.
void Keeper::begin(First first) {
  first.bytes.assign(first.place.bytes.begin(), first.place.bytes.end());
  first.place.bytes = first.bytes;
  first_ = std::move(first);
  try_to_begin();
}

void Keeper::try_to_begin() {
  if (!file_ && !open(first_->about)) return;
  try {
    if (!first_->index) first_->index = others_->hear(first_->place, &first_->about);
    if (first_->index) keep(first_->place, session_in_file(*first_->index));
    first_.reset();
  } catch (const sqlite::SaveError& error) {
    fail(error.what());
  }
}

void Keeper::fail(std::string why) {
  if (failing_.empty()) news_.push_back(why);
  failing_ = std::move(why);
}

void Keeper::keep(const dds::FleetPlace& place, Session& session) {
  session.gone = false;
  if (session.closed) return;
  session.records.push_back({number_of(session.id, place.frame), place.frame, place.time_ns});
  session.bytes.insert(session.bytes.end(), place.bytes.begin(), place.bytes.end());
  session.frames = place.frame + 1;
  ++waiting_;
}

/// A session of the file for one that is heard. Throws SaveError.
Keeper::Session& Keeper::session_in_file(std::uint32_t index) {
  if (heard_as_.size() <= index) heard_as_.resize(index + 1);
  // Begun before, and killed before anything of it was saved.
  const std::int64_t began = others_->names(index).began_ns;
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    if (!sessions_[i].grows || sessions_[i].names.began_ns != began) continue;
    heard_as_[index] = i;
    return sessions_[i];
  }
  Session session;
  session.names = others_->names(index);
  const std::string title = session.names.robot + " " + session.names.session;
  const auto known = file_->sessions();
  std::string name = title;
  for (int more = 2; std::ranges::find(known, name, &sqlite::SessionFacts::name) != known.end();) {
    name = fmt::format("{}-{}", title, more++);
  }
  const Json settings{{"robot", session.names.robot}, {"session", session.names.session}};
  session.id = file_->begin_session(name, session.names.began_ns, json_text(settings));
  news_.push_back(fmt::format("what robot '{}' tells of session '{}' is kept as '{}'",
                              session.names.robot, session.names.session, name));
  heard_as_[index] = sessions_.size();
  sessions_.push_back(std::move(session));
  return sessions_.back();
}

/// All that waits; what the disk does not take goes on waiting.
void Keeper::save() {
  saved_ = std::chrono::steady_clock::now();
  if (first_) try_to_begin();
  try {
    for (Session& session : sessions_) {
      if (session.records.empty() && session.links.empty() && !session.statistics) continue;
      try {
        file_->save(session.id,
                    {.frames = session.frames,
                     .records = session.records,
                     .places = session.bytes,
                     .links = session.links,
                     .statistics = session.statistics ? &*session.statistics : nullptr});
      } catch (const std::invalid_argument&) {
        session.closed = true;
        news_.push_back(
            fmt::format("robot '{}', session '{}': no more of it is kept: a drive was "
                        "added to the map behind it",
                        session.names.robot, session.names.session));
      }
      waiting_ -= session.records.size() + session.links.size();
      session.records.clear();
      session.bytes.clear();
      session.links.clear();
      session.statistics.reset();
    }
    if (!first_ && !std::exchange(failing_, {}).empty())
      news_.emplace_back("what was told is saved again");
  } catch (const sqlite::SaveError& error) {
    fail(error.what());
  }
}

/// What nobody else tells. Work: the file, once, where there is any of that.
void Keeper::tell(const std::function<bool()>& stop) {
  const auto wanted = [](const Session& session) {
    return session.gone && session.untold < session.frames;
  };
  if (std::ranges::none_of(sessions_, wanted)) return;
  save();
  if (!failing_.empty()) return;
  std::map<std::int64_t, Session*> telling;
  for (Session& session : sessions_) {
    if (wanted(session)) telling[session.id] = &session;
  }
  // Robots hear no more, and the newest are worth more to them.
  for (; telling.size() > most_fleet_sessions; telling.erase(telling.begin())) {
    Session& oldest = *telling.begin()->second;
    oldest.untold = oldest.frames;
  }
  const sqlite::MapForm& form = file_->form();
  const auto size = static_cast<std::size_t>(form.place_bytes);
  bool going = true;
  std::map<std::int64_t, std::uint64_t> told;
  file_->read([&](const sqlite::PlaceBlock& block) {
    const auto found = telling.find(block.session);
    if (found == telling.end()) return;
    const Session& session = *found->second;
    const dds::FleetSession about{session.names.robot,
                                  session.names.session,
                                  form.form,
                                  form.describer,
                                  static_cast<std::uint32_t>(form.descriptor_size),
                                  static_cast<std::uint32_t>(form.place_bytes)};
    for (std::size_t i = 0; i < block.records.size() && going; ++i) {
      const sqlite::PlaceRecord& record = block.records[i];
      if (record.frame < session.untold) continue;
      const bool says = told[block.session]++ % said_every == 0;
      going = publish({session.names.began_ns,
                       record.frame,
                       record.time_ns,
                       block.places.subspan(i * size, size),
                       {},
                       {}},
                      says ? &about : nullptr, stop);
    }
  });
  file_->read_links([&](const sqlite::SavedLink& link) {
    if (!going || !link.place || !telling.contains(link.session)) return;
    const auto place = told_as(*link.place);
    const auto other = told_as(link.other);
    if (place && other)
      going = publish({place->session, place->frame, 0, {}, other, {}}, nullptr, stop);
  });
  for (const auto& [id, session] : telling) {
    const auto its = file_->statistics(id);
    if (!going || !its) continue;
    dds::FleetPlace none{.session = session->names.began_ns};
    none.statistics = {its->frames, its->mean, its->variance};
    going = publish(none, nullptr, stop);
  }
  if (!going) return;
  for (const auto& [id, session] : telling) session->untold = session->frames;
}

/// @return false where it is to stop
bool Keeper::publish(const dds::FleetPlace& place, const dds::FleetSession* about,
                     const std::function<bool()>& stop) {
  while (!stop()) {
    if (wire_.publish(place, about)) return true;
  }
  return false;
}

/// What a place of the file is to others.
std::optional<dds::FleetVisit> Keeper::told_as(std::uint64_t number) const {
  if (const auto found = earlier_.find(number); found != earlier_.end()) return found->second;
  const auto id = static_cast<std::int64_t>(session_of(number));
  const auto session = std::ranges::find(sessions_, id, &Session::id);
  if (session == sessions_.end() || !session->grows) return std::nullopt;
  return dds::FleetVisit{session->names.began_ns, frame_of(number)};
}

std::string Keeper::end() {
  save();
  if (!file_) return "nothing is kept";
  if (wire_.others() > 0) wire_.flush(patience);
  std::uint64_t places = 0;
  const auto sessions = file_->sessions();
  for (const sqlite::SessionFacts& facts : sessions) places += facts.places;
  stays_in_log_ = move_log_into(*file_).value_or("");
  return fmt::format("{} of {} {} kept", counted(places, "place"),
                     counted(sessions.size(), "session"), are(places));
}

std::string Keeper::unsaved() const {
  if (failing_.empty()) return stays_in_log_;
  std::size_t places = first_ ? 1 : 0;
  for (const Session& session : sessions_) places += session.records.size();
  // While the disk is full, more may wait in DDS, which nobody has counted.
  return fmt::format(
      "not saved of what was told: {} or more: {}; robots that still run tell it again",
      counted(places, "place"), failing_);
}

}  // namespace seqloop::program
