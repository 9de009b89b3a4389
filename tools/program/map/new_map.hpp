// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// A map that appears under its name only when it is complete. Until then it is
/// `.NAME.partial-PID` in the same folder; the destructor removes that if it was not made.
class NewMap {
 public:
  /// Throws SetupError: there is such a file already, or what is left of another map; the folder is
  /// missing or may not be written.
  explicit NewMap(std::filesystem::path path);
  NewMap(const NewMap&) = delete;
  NewMap& operator=(const NewMap&) = delete;
  NewMap(NewMap&&) = delete;
  NewMap& operator=(NewMap&&) = delete;
  ~NewMap();

  /// Where it is until then; empty at first.
  [[nodiscard]] const std::filesystem::path& partial() const noexcept { return partial_; }

  /// The map there. Throws SetupError.
  sqlite::MapFile& open(const sqlite::MapForm& form);

  /// Runs what fills the map, and closes it; then it is there under its own name. The last call.
  /// Throws what `fill` throws; SaveError, by the map's own name; IoError.
  void make(const std::function<void()>& fill);

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;
  std::optional<sqlite::MapFile> map_;
};

}  // namespace seqloop::program
