// SPDX-License-Identifier: MIT
#include "program/map/stored_map.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "program/map/place_form.hpp"
#include "program/process/interruption.hpp"
#include "ros/wall_time.hpp"

namespace seqloop::program {
namespace {

constexpr const char* of_pictures =
    "`seqloop run --source PICTURES --map FILE` describes them as the map's were, and a .npy file "
    "does not say how its own were";

/// Whether a map was made from pictures, and what is matched was described before.
bool wants_pictures(const sqlite::MapForm& map, const sqlite::MapForm& drive) {
  return drive.describer == "descriptors" && map.describer != drive.describer;
}

/// The form of a map, if it can be read.
std::optional<sqlite::MapForm> form_at(const std::filesystem::path& path) {
  try {
    return sqlite::MapFile::read_only(path).form();
  } catch (const SetupError&) {
    return std::nullopt;
  }
}

/// Opens a map to write. Throws SetupError.
sqlite::MapFile opened_to_write(const std::filesystem::path& path, const sqlite::MapForm& form) {
  try {
    return sqlite::MapFile::open(path, form);
  } catch (const SetupError& error) {
    const auto there = form_at(path);
    if (!there || !wants_pictures(*there, form)) throw;
    Faults faults = error.faults();
    faults.back().remedy = of_pictures;
    throw SetupError(std::move(faults));
  }
}

sqlite::MapFile opened(const MapSettings& settings, const MatcherConfig& config,
                       std::size_t descriptor_size, std::string describer) {
  const PlaceMap one(config, {1, descriptor_size});
  const sqlite::MapForm form{form_of(config), std::move(describer), descriptor_size,
                             one.rows().saved_size()};
  if (!settings.read_only) {
    sqlite::MapFile file = opened_to_write(settings.file, form);
    // Refused, a drive would leave a file that binds others to its form.
    file.drop_if_unused();
    return file;
  }
  sqlite::MapFile file = sqlite::MapFile::read_only(settings.file);
  if (file.form() == form) return file;
  throw SetupError(
      {settings.file.string(),
       fmt::format("its places are {}, of {} values, described by '{}'; these are {}, "
                   "of {}, by '{}'",
                   file.form().form, file.form().descriptor_size, file.form().describer, form.form,
                   form.descriptor_size, form.describer),
       wants_pictures(file.form(), form) ? of_pictures
                                         : "describe and compare as when the map was made"});
}

}  // namespace

StoredMap::StoredMap(const MapSettings& settings, const MatcherConfig& config,
                     std::size_t descriptor_size, std::string describer)
    : file_(opened(settings, config, descriptor_size, std::move(describer))),
      read_only_(settings.read_only),
      new_name_(settings.session),
      descriptor_size_(descriptor_size) {
  for (const sqlite::SessionFacts& session : file_.sessions()) {
    places_ += static_cast<std::size_t>(session.places);
    begun_.push_back(session.began_ns);
    if (session.places > 0) names_.push_back(session.name);
    if (!new_name_.empty() && session.name == new_name_) {
      throw SetupError({"session", "the map has one of the name '" + new_name_ + "'",
                        "give it another, or leave --session out"});
    }
  }
  if (read_only_ && places_ == 0) {
    throw SetupError({settings.file.string(), "it has no places", "drive with --map first"});
  }
}

Capacity StoredMap::capacity(std::size_t drive) const noexcept {
  // One session more: the drive's. It is some bytes where nothing is added. Two in a new map, too:
  // what is told of each of its drives are places (src/README.md, 5.12), which the file keeps.
  return {std::max<std::size_t>(places_ + (read_only_ ? 0 : drive), 1), descriptor_size_,
          std::max<std::size_t>(names_.size() + 1, 2)};
}

void StoredMap::load(PlaceMap& map) {
  const auto damaged = [this](const std::string& why) {
    return SetupError({file_.path().string(), why, "seqloop map check says more"});
  };
  Progress progress("loading", places_);
  const std::size_t bytes = map.rows().saved_size();
  std::vector<PlaceMap::Saved> places;
  std::optional<std::int64_t> newest;
  file_.read([&](const sqlite::PlaceBlock& block) {
    stop_if_interrupted();
    if (newest && *newest != block.session && !map.begin_session()) {
      throw damaged("it has more sessions than it says");
    }
    newest = block.session;
    places.clear();
    for (std::size_t i = 0; i < block.records.size(); ++i) {
      const sqlite::PlaceRecord& record = block.records[i];
      places.push_back({record.number, record.frame, block.places.subspan(i * bytes, bytes)});
    }
    if (const std::size_t added = map.add_saved(places); added != places.size()) {
      throw damaged(fmt::format("place {} is none that can follow", places[added].number));
    }
    progress.step(places.size());
  });
  progress.done();
  map.count_from(file_.next_place());
  const auto row_of = [&](std::uint64_t number) { return map.order().row_of_number(number); };
  file_.read_links([&](const sqlite::SavedLink& link) {
    if (!link.place) return;
    if (const auto row = row_of(*link.place)) map.set_first_visit(*row, link.other);
  });
  // Of a robot's short session, a keeper may have none.
  for (const sqlite::SessionFacts& session : file_.sessions()) {
    if (session.places == 0) continue;
    if (const auto statistics = file_.statistics(session.id)) {
      static_cast<void>(
          map.set_statistics(statistics->mean, statistics->variance, statistics->frames));
    }
  }
}

void StoredMap::begin_session(const std::string& settings) {
  if (read_only_) return;
  const std::int64_t began = ros::wall_ns();
  std::string name = new_name_;
  if (name.empty()) {
    const auto known = file_.sessions();
    const auto taken = [&](const std::string& other) {
      return std::ranges::find(known, other, &sqlite::SessionFacts::name) != known.end();
    };
    const std::string when = fmt::format(
        "{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(began / 1'000'000'000)));
    name = when;
    for (int more = 2; taken(name); ++more) name = fmt::format("{}-{}", when, more);
  }
  session_ = file_.begin_session(name, began, settings);
  names_.push_back(name);
  begun_.push_back(began);
}

void StoredMap::forget_session() {
  const std::string& name = names_.back();
  if (std::exchange(session_, 0) == 0) return;
  try {
    file_.forget(name);
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: a part of the drive stays, as session '{}': {}",
                                         path().string(), name, error.what()));
  }
}

PlaceForm StoredMap::form() const {
  const sqlite::MapForm& form = file_.form();
  return {form.form, form.describer, static_cast<std::size_t>(form.descriptor_size),
          static_cast<std::size_t>(form.place_bytes)};
}

}  // namespace seqloop::program
