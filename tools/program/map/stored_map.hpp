// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "program/map/lasting_map.hpp"
#include "program/map/map_settings.hpp"
#include "program/process/progress.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"
#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// A map's file, opened for a run: what it holds, and the session that the run adds.
class StoredMap {
 public:
  /// @param describer what describes the drive: only what was described alike can be compared
  /// Throws SetupError.
  StoredMap(const MapSettings& settings, const MatcherConfig& config, std::size_t descriptor_size,
            std::string describer);

  /// Places that it holds.
  [[nodiscard]] std::size_t places() const noexcept { return places_; }

  /// What a map needs room for to take them all, and the drive.
  /// @param drive places that the drive will add at most
  [[nodiscard]] Capacity capacity(std::size_t drive) const noexcept;

  /// Fills an empty map. Work: the whole file. Throws SetupError: damaged.
  void load(PlaceMap& map);

  /// Begins the session of this run, unless the map is only read. Throws SetupError.
  /// @param settings the run's, as a text for who reads the file
  void begin_session(const std::string& settings);

  /// Removes it from the file again, if it is there. Throws std::runtime_error: it stays.
  void forget_session();

  [[nodiscard]] bool read_only() const noexcept { return read_only_; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_.path(); }
  [[nodiscard]] sqlite::MapFile& file() noexcept { return file_; }
  [[nodiscard]] const sqlite::MapFile& file() const noexcept { return file_; }
  [[nodiscard]] std::int64_t session() const noexcept { return session_; }
  [[nodiscard]] PlaceForm form() const;

  /// When each session of the file began; of this run's, the last.
  [[nodiscard]] const std::vector<std::int64_t>& begun() const noexcept { return begun_; }

  /// What all places of this run's session have in common; the rest is empty.
  [[nodiscard]] SavedPlace of_this_run() const { return {begun_.back(), names_.back()}; }

  /// The name of a session, as the map counts them: those without places are not counted.
  [[nodiscard]] const std::string& name(std::size_t session) const noexcept {
    return names_[session];
  }

 private:
  sqlite::MapFile file_;
  bool read_only_;
  std::string new_name_;
  std::size_t descriptor_size_;
  std::size_t places_ = 0;
  std::int64_t session_ = 0;
  std::vector<std::int64_t> begun_;
  std::vector<std::string> names_;  // of the sessions that have places, and of this run's
};

}  // namespace seqloop::program
