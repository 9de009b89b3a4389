// SPDX-License-Identifier: MIT
#include "python/map.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "program/drives/map_builder.hpp"
#include "program/map/map_settings.hpp"
#include "program/options/flag_names.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/options/verb.hpp"
#include "python/interpreter_lock.hpp"
#include "python/recordings.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/detail/detector_faults.hpp"
#include "seqloop/files/descriptor_source.hpp"
#include "seqloop/opencv/builtin_describer.hpp"

namespace seqloop::python {
namespace {

namespace py = pybind11;

// The interpreter's lock may be others' for milliseconds.
constexpr std::uint64_t frames_between_looks = 64;

std::size_t size_of(std::int64_t value) {
  return static_cast<std::size_t>(std::max<std::int64_t>(value, 0));
}

void check(Faults& faults, std::int64_t places, std::int64_t descriptor_size,
           const MatcherConfig& config) {
  for (Fault& fault : capacity_faults(config, {size_of(places), size_of(descriptor_size)})) {
    // What is below 0 was looked at as 0.
    const std::int64_t given = fault.what == "places"            ? places
                               : fault.what == "descriptor_size" ? descriptor_size
                                                                 : 0;
    if (given < 0) fault.why.replace(0, 1, std::to_string(given));
    faults.push_back(program::in_flags(std::move(fault)));
  }
}

constexpr auto nothing_said = "descriptors";

/// The program's remedy is for who has nothing but descriptors. Here there may be a describer.
void suit_remedies(Faults& faults, const std::string& describer) {
  if (describer != nothing_said) return;
  for (Fault& fault : faults) {
    if (fault.why.find("described by") == std::string::npos) continue;
    if (fault.why.find(fmt::format("described by '{}'", nothing_said)) != std::string::npos)
      continue;
    fault.remedy = "describer=describer.fingerprint, of a Describer as the one that made the map";
  }
}

}  // namespace

Map::Map(Chosen chosen)
    : config_(chosen.config),
      method_(std::move(chosen.method)),
      in_file_(chosen.file != nullptr),
      opened_by_(::getpid()),
      map_(config_, chosen.capacity),
      open_file_(std::move(chosen.open_file)),
      file_(std::move(chosen.file)) {
  opencv::expect_builtin(map_);
}

Map::~Map() {
  if (!opened_elsewhere()) return;
  // What saves is no thread of this process, and closing SQLite's file may remove the log beside
  // it.
  static_cast<void>(saving_.release());
  static_cast<void>(file_.release());
}

std::shared_ptr<Map> Map::in_memory(std::int64_t places, std::int64_t descriptor_size,
                                    bool close_loops, const py::kwargs& settings) {
  Faults faults;
  const MatcherConfig config =
      config_of(close_loops ? Use::close_loops : Use::localise, size_of(places), settings, faults);
  check(faults, places, descriptor_size, config);
  program::refuse(std::move(faults));
  const Unlocked unlocked;
  return std::shared_ptr<Map>(new Map(Chosen{config, {size_of(places), size_of(descriptor_size)}}));
}

std::shared_ptr<Map> Map::open(const std::filesystem::path& file, std::int64_t descriptor_size,
                               std::optional<std::int64_t> places, const std::string& describer,
                               const py::kwargs& given) {
  constexpr std::int64_t usual_drive = 20'000;
  Faults faults;
  program::MapSettings settings;
  program::MatcherSettings matcher;
  program::OptionTable options;
  add_map_options(options, settings);
  add_matcher_options(options, matcher);
  const std::string listed = "seqloop.settings() and help(seqloop.PlaceMap.open)";
  for (Fault& fault : set_options(options, given, listed)) faults.push_back(std::move(fault));
  settings.file = file;
  if (file.empty()) faults.push_back({"map", "its name is empty", "name a file"});
  check(settings, false, faults);
  Chosen chosen;
  chosen.method = matcher.method;
  chosen.config = resolve(matcher, settings.read_only ? Use::localise : Use::close_loops, faults);
  // The file is opened last: a missing one is made.
  check(faults, places.value_or(usual_drive), descriptor_size, chosen.config);
  program::refuse(std::move(faults));
  const std::size_t drive = size_of(places.value_or(usual_drive));
  const Unlocked unlocked;
  chosen.open_file = std::make_unique<OpenFile>(file, settings.read_only);
  try {
    chosen.file = program::open_map(settings, chosen.config, size_of(descriptor_size), describer);
  } catch (const SetupError& error) {
    faults = error.faults();
    suit_remedies(faults, describer);
    throw SetupError(std::move(faults));
  }
  chosen.capacity = chosen.file->capacity(drive);
  if (places) {
    if (chosen.file->places() > drive) {
      throw SetupError({"max_places",
                        "the map has " + counted(chosen.file->places(), "place") + " already",
                        "raise max_places"});
    }
    chosen.capacity.places = drive;
  }
  suit_slice(chosen.config, matcher, chosen.capacity.places);
  std::shared_ptr<Map> map(new Map(std::move(chosen)));
  map->file_->load(map->map_);
  return map;
}

void Map::add_drive(const Given& descriptors) {
  Faults faults;
  if (in_file_) {
    faults.push_back({"map", "it is kept in a file: a detector adds its drive to it",
                      "step through the drive, or make a PlaceMap without a file"});
  } else if (config_.use == Use::close_loops) {
    faults.push_back({"map", "it is for closing loops: it takes its places from the drive",
                      "leave close_loops out to localise in an earlier drive"});
  }
  std::optional<files::Matrix> drive;
  program::collect(faults, [&] {
    drive = matrix(drive_of(descriptors, "descriptors"), "descriptors", config_.difference);
  });
  if (drive && drive->columns != map_.descriptor_size()) {
    faults.push_back({"descriptors",
                      "a row has " + std::to_string(drive->columns) + " values, the map's have " +
                          std::to_string(map_.descriptor_size()),
                      "describe all with the same describer"});
  }
  program::refuse(std::move(faults));
  const Unlocked unlocked;
  const auto locked = lock();
  if (map_.size() != 0) {
    throw SetupError({"map", "it holds a drive already", "make a map for each drive"});
  }
  files::DescriptorSource source(std::move(*drive));
  program::Progress silent;
  const auto look = [](const Frame& frame) {
    if (frame.index % frames_between_looks == 0) look_for_interruption();
  };
  try {
    frames_ = program::fill_map(map_, source, nullptr, config_, silent, look).frames;
  } catch (...) {  // a part of a drive is none to localise in
    map_ = PlaceMap(config_, {map_.capacity(), map_.descriptor_size()});
    opencv::expect_builtin(map_);
    throw;
  }
}

std::size_t Map::size() {
  const Unlocked unlocked;
  const auto locked = lock();
  return map_.size();
}

std::string Map::text() {
  return fmt::format("PlaceMap(max_places={}, descriptor_size={}, close_loops={})", capacity(),
                     descriptor_size(), config_.use == Use::close_loops ? "True" : "False");
}

program::LastingMap* Map::file() {
  if (in_file_ && !file_) throw SetupError({"map", "it is closed", "open it again"});
  return file_.get();
}

std::pair<std::string, std::optional<std::uint64_t>> Map::where(std::uint64_t place) {
  const Unlocked unlocked;
  const auto locked = lock();
  const program::LastingMap* const kept = file();
  if (kept == nullptr) {
    throw SetupError({"map", "it is in no file, and has one drive", "the place is its frame"});
  }
  if (place >= map_.order().next_number()) {
    throw SetupError({"place", std::to_string(place) + " is none of the map"});
  }
  const program::LastingMap::Seen seen = kept->where(place);
  return {std::string(seen.session), seen.frame};
}

std::uint64_t Map::saved() {
  const Unlocked unlocked;
  const auto locked = lock();
  const program::LastingMap* const kept = file();
  if (kept == nullptr) throw SetupError({"map", "it is in no file", "PlaceMap.open"});
  return kept->saved();
}

void Map::close() {
  if (opened_elsewhere()) return;
  const Unlocked unlocked;
  const auto locked = lock();
  saving_.reset();
  file_.reset();
  open_file_.reset();
}

bool Map::opened_elsewhere() const noexcept { return in_file_ && opened_by_ != ::getpid(); }

std::unique_lock<std::mutex> Map::lock() {
  // Before the lock, which a thread of the other process may have held. A map that is only read is
  // in memory, whole.
  if (opened_elsewhere() && config_.use == Use::close_loops) {
    throw SetupError({"map", fmt::format("process {} opened it, and this is a fork", opened_by_),
                      "open a map in the process that uses it"});
  }
  return std::unique_lock(mutex_);
}

void Map::claim() {
  static_cast<void>(file());
  if (config_.use != Use::close_loops) return;
  if (claimed_) {
    throw SetupError({"map", "a detector has begun to add its drive to it", "make another map"});
  }
  claimed_ = true;
}

void Map::begin() {
  if (file_) saving_ = file_->begin(map_, config_, method_);
}

}  // namespace seqloop::python
