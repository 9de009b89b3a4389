// SPDX-License-Identifier: MIT
#include "program/fleet/others.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "program/fleet/fleet_settings.hpp"
#include "program/map/place_form.hpp"
#include "program/process/say.hpp"

namespace seqloop::program {
namespace {

// No camera sees more; what is told faster is no drive.
constexpr std::uint64_t most_a_second = 1000;

// Visits that wait for their places: seconds' worth of many robots.
constexpr std::size_t most_early = 1024;

// A name is for people.
constexpr std::size_t longest_name = 100;

std::string name_of(const std::string& text, const char* otherwise) {
  if (text.empty()) return otherwise;
  return printable(std::string_view(text).substr(0, longest_name));
}

std::string form_of(const dds::FleetSession& session) {
  return fmt::format("{}, of {} values, described by '{}'", name_of(session.form, "nothing"),
                     session.descriptor_size, name_of(session.describer, "nothing"));
}

bool alike(const dds::FleetSession& one, const dds::FleetSession& other) {
  return one.form == other.form && one.describer == other.describer &&
         one.descriptor_size == other.descriptor_size && one.place_bytes == other.place_bytes;
}

std::string title(const Others::Names& names) {
  return fmt::format("robot '{}', session '{}'", names.robot, names.session);
}

}  // namespace

Others::Others(dds::FleetSession own, std::vector<std::int64_t> in_map, std::size_t places)
    : own_(std::move(own)), in_map_(std::move(in_map)), room_(places) {
  std::ranges::sort(in_map_);
  names_.reserve(most_fleet_sessions);
}

Others::Names Others::names_of(const dds::FleetSession& session, std::int64_t began_ns) {
  return {name_of(session.robot, "without a name"), name_of(session.name, "without a name"),
          began_ns};
}

std::optional<std::uint32_t> Others::hear(const dds::FleetPlace& place,
                                          const dds::FleetSession* about) {
  if (std::ranges::binary_search(in_map_, place.session)) return std::nullopt;
  Session* const session = known(place, about);
  if (session == nullptr || session->refused) return std::nullopt;
  // From several who have it, or again after a restart.
  if (session->places > 0 && place.frame <= session->frame) return std::nullopt;
  if (const auto why = fault(*session, place)) {
    session->refused = true;
    tell(fmt::format("{}: {}: no more of it is taken in", title(session->names), *why));
    return std::nullopt;
  }
  if (taken_ == room_) {
    if (!std::exchange(full_, true)) {
      tell(
          fmt::format("there is room for {} places of other robots, and more have come; raise "
                      "--fleet-places",
                      room_));
    }
    return std::nullopt;
  }
  if (session->places == 0) session->first_ns = place.time_ns;
  session->frame = place.frame;
  session->newest_ns = place.time_ns;
  ++session->places;
  ++taken_;
  if (!session->index) {
    session->index = static_cast<std::uint32_t>(names_.size());
    names_.push_back(session->names);
  }
  return session->index;
}

std::uint32_t Others::resume(const Names& names, const Before& before) {
  const auto index = static_cast<std::uint32_t>(names_.size());
  names_.push_back(names);
  taken_ += before.places;
  sessions_[names.began_ns] = {names,        index,           false,           before.places,
                               before.frame, before.first_ns, before.newest_ns};
  return index;
}

std::optional<Others::SamePlace> Others::same_place(const dds::FleetPlace& place) const {
  const auto has = [this](std::int64_t session, std::uint64_t frame) {
    const auto found = sessions_.find(session);
    if (found == sessions_.end() || frame > found->second.frame) {
      return std::optional<std::uint32_t>();
    }
    return found->second.index;
  };
  const auto session = has(place.session, place.frame);
  const auto visited = has(place.visit->session, place.visit->frame);
  if (!session || !visited) return std::nullopt;
  return SamePlace{*session, *visited};
}

void Others::wait_for_places(const dds::FleetPlace& visit) {
  if (!may_be_heard(visit.session) || !may_be_heard(visit.visit->session)) return;
  if (early_.size() == most_early) {
    early_.pop_front();
    looked_at_ -= std::min<std::size_t>(looked_at_, 1);
  }
  early_.push_back(visit);
}

std::optional<dds::FleetPlace> Others::next_visit() {
  if (std::exchange(taken_then_, taken_) != taken_) looked_at_ = 0;
  for (; looked_at_ < early_.size(); ++looked_at_) {
    if (!same_place(early_[looked_at_])) continue;
    const dds::FleetPlace visit = early_[looked_at_];
    early_.erase(early_.begin() + static_cast<std::ptrdiff_t>(looked_at_));
    return visit;
  }
  return std::nullopt;
}

bool Others::may_be_heard(std::int64_t session) const {
  if (std::ranges::binary_search(in_map_, session)) return false;
  const auto found = sessions_.find(session);
  return found == sessions_.end() || !found->second.refused;
}

std::optional<std::uint32_t> Others::statistics(const dds::FleetPlace& place) {
  const auto found = sessions_.find(place.session);
  if (found == sessions_.end() || found->second.refused || !found->second.index) {
    return std::nullopt;
  }
  const dds::FleetStatistics& its = *place.statistics;
  const auto can_be = [](double value) { return std::isfinite(value); };
  const auto can_vary = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (its.frames > 0 && its.mean.size() == own_.descriptor_size &&
      its.variance.size() == own_.descriptor_size && std::ranges::all_of(its.mean, can_be) &&
      std::ranges::all_of(its.variance, can_vary)) {
    return found->second.index;
  }
  found->second.refused = true;
  tell(title(found->second.names) +
       ": what it says of how its places were standardised cannot be: no more of it is taken in");
  return std::nullopt;
}

/// @return null where nothing is known of the session, and nothing is to be
Others::Session* Others::known(const dds::FleetPlace& place, const dds::FleetSession* about) {
  const auto found = sessions_.find(place.session);
  if (found != sessions_.end()) return &found->second;
  if (about == nullptr) return nullptr;
  if (sessions_.size() >= most_fleet_sessions) {
    if (!std::exchange(crowded_, true)) {
      tell(
          fmt::format("other robots have more than {} sessions: what is beyond is not heard; let a "
                      "keeper's map forget old ones (`seqloop map forget`)",
                      most_fleet_sessions));
    }
    return nullptr;
  }
  Session session;
  session.names = names_of(*about, place.session);
  session.refused = !alike(*about, own_);
  if (session.refused) {
    tell(
        fmt::format("{}: its places are {}; these are {}: none is taken in; describe and compare "
                    "alike on both",
                    title(session.names), form_of(*about), form_of(own_)));
  }
  return &sessions_.emplace(place.session, std::move(session)).first->second;
}

/// @return why nothing more is to be heard of a session
std::optional<std::string> Others::fault(const Session& session,
                                         const dds::FleetPlace& place) const {
  if (place.bytes.size() != own_.place_bytes) {
    return fmt::format("it says {} bytes a place, and sends {}", own_.place_bytes,
                       place.bytes.size());
  }
  // A map that has such a place is one that nobody can load.
  if (!can_be_place(own_.form, place.bytes)) return "it sends values that are no numbers";
  if (session.places == 0) return std::nullopt;
  if (place.time_ns < session.newest_ns) return "its time goes back";
  // Unsigned: from the least time to the greatest, too.
  const std::uint64_t driven_ns =
      static_cast<std::uint64_t>(place.time_ns) - static_cast<std::uint64_t>(session.first_ns);
  constexpr std::uint64_t a_second = 1'000'000'000;
  if (session.places / most_a_second > driven_ns / a_second + 1) {
    return fmt::format("it has more than {} places a second of its drive", most_a_second);
  }
  return std::nullopt;
}

void Others::tell(std::string text) { news_.push_back(std::move(text)); }

std::vector<std::string> Others::news() { return std::exchange(news_, {}); }

}  // namespace seqloop::program
