// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "program/map/lasting_map.hpp"
#include "python/bindings.hpp"
#include "python/open_file.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::python {

/// A map, and what keeps threads apart that use it. Kept in a file or not. A file that is written
/// belongs to the process that opened it: in a fork of that, calls throw SetupError, and the file
/// stays as it is.
class Map {
 public:
  /// In memory alone. Throws SetupError.
  [[nodiscard]] static std::shared_ptr<Map> in_memory(std::int64_t places,
                                                      std::int64_t descriptor_size,
                                                      bool close_loops,
                                                      const pybind11::kwargs& settings);

  /// In a file. @param places how many there is room for; none: for what it has, and 20,000 more
  /// @param settings also those of maps in files
  /// Throws SetupError, also where this build has no maps in files.
  [[nodiscard]] static std::shared_ptr<Map> open(const std::filesystem::path& file,
                                                 std::int64_t descriptor_size,
                                                 std::optional<std::int64_t> places,
                                                 const std::string& describer,
                                                 const pybind11::kwargs& settings);

  Map(const Map&) = delete;
  Map& operator=(const Map&) = delete;
  ~Map();

  /// Of the drive to localise in, those that became no places, too. With the lock.
  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }

  /// Fills it with a drive to localise in. Throws SetupError, KeyboardInterrupt; then it is empty.
  void add_drive(const Given& descriptors);

  [[nodiscard]] std::size_t size();
  [[nodiscard]] std::size_t capacity() { return map_.capacity(); }
  [[nodiscard]] std::size_t descriptor_size() { return map_.descriptor_size(); }

  /// What it is, without waiting for who uses it.
  [[nodiscard]] std::string text();

  /// The session that a place is of, and its frame there; no frame once the place is forgotten.
  /// Throws SetupError: no such place, or no map in a file.
  [[nodiscard]] std::pair<std::string, std::optional<std::uint64_t>> where(std::uint64_t place);

  /// Frames of this drive that are on the disk for good. Throws SetupError: no map in a file.
  [[nodiscard]] std::uint64_t saved();

  /// Closes the file; what is not saved by then is lost.
  void close();

  [[nodiscard]] const MatcherConfig& config() const noexcept { return config_; }
  [[nodiscard]] PlaceMap& places() noexcept { return map_; }

  /// Keeps other threads away, as long as it lives. Without the interpreter's lock.
  [[nodiscard]] std::unique_lock<std::mutex> lock();

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
    std::unique_ptr<OpenFile> open_file = {};
    std::unique_ptr<program::LastingMap> file = {};
  };
  explicit Map(Chosen chosen);

  /// Whether this is a fork of the process that opened the file.
  [[nodiscard]] bool opened_elsewhere() const noexcept;

  std::mutex mutex_;
  MatcherConfig config_;
  std::string method_;
  bool in_file_;
  pid_t opened_by_;
  bool claimed_ = false;
  std::size_t frames_ = 0;
  PlaceMap map_;
  std::unique_ptr<OpenFile> open_file_;
  std::unique_ptr<program::LastingMap> file_;
  program::LastingMap::Saving saving_;  // reads the map
};

}  // namespace seqloop::python
