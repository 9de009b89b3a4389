// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "program/map/lasting_map.hpp"
#include "python/bindings.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::python {

/// A map, and what keeps threads apart that use it. Kept in a file or not.
class Map {
 public:
  /// In memory alone. Throws SetupError.
  Map(std::int64_t places, std::int64_t descriptor_size, bool close_loops,
      const pybind11::kwargs& settings);

  /// In a file. @param places how many there is room for; none: for what it has, and 20,000 more
  /// @param settings also those of maps in files
  /// Throws SetupError, also where this build has no maps in files.
  [[nodiscard]] static std::shared_ptr<Map> open(const std::filesystem::path& file,
                                                 std::int64_t descriptor_size,
                                                 std::optional<std::int64_t> places,
                                                 const std::string& describer,
                                                 const pybind11::kwargs& settings);

  /// Fills it with a drive to localise in. Throws SetupError, KeyboardInterrupt; then it is empty.
  void add_drive(const Given& descriptors);

  [[nodiscard]] std::size_t size();

  /// The session that a place is of, and its frame there; no frame once the place is forgotten.
  /// Throws SetupError: no such place, or no map in a file.
  [[nodiscard]] std::pair<std::string, std::optional<std::uint64_t>> where(std::uint64_t place);

  /// Frames of this drive that are on the disk for good. Throws SetupError: no map in a file.
  [[nodiscard]] std::uint64_t saved();

  /// Closes the file; what is not saved by then is lost.
  void close();

  [[nodiscard]] const MatcherConfig& config() const noexcept { return config_; }
  [[nodiscard]] PlaceMap& places() noexcept { return map_; }
  [[nodiscard]] std::mutex& mutex() noexcept { return mutex_; }

  /// What saves it, for who holds the lock; null: nothing does. Throws SetupError: closed.
  [[nodiscard]] program::LastingMap* file();

  /// To be called by a detector, with the lock. One that closes loops shares its map with none.
  void claim();

  /// The detector's drive begins. With the lock. Throws SetupError.
  void begin();

 private:
  struct Chosen {
    MatcherConfig config;
    Capacity capacity;
    std::string method = {};
    std::unique_ptr<program::LastingMap> file = {};
  };
  explicit Map(Chosen chosen);

  static Chosen in_memory(std::int64_t places, std::int64_t descriptor_size, bool close_loops,
                          const pybind11::kwargs& settings);

  std::mutex mutex_;
  MatcherConfig config_;
  std::string method_;
  bool in_file_;
  bool claimed_ = false;
  PlaceMap map_;
  std::unique_ptr<program::LastingMap> file_;
  program::LastingMap::Saving saving_;  // reads the map
};

}  // namespace seqloop::python
