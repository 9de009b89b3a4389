// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "sqlite/database.hpp"

namespace seqloop::sqlite {

/// The one process that writes a map. A lock on the file itself, which ends with the process
/// however that ends, and not one of those that SQLite takes; who it is stands in the table
/// `holder`.
class Holder {
 public:
  /// Nobody.
  Holder() = default;
  /// Makes the file where there is none. Throws SetupError: held, not a file, not writable.
  explicit Holder(const std::filesystem::path& path);
  Holder(Holder&& other) noexcept;
  Holder& operator=(Holder&&) = delete;
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;
  ~Holder();

  /// Whether the file was not there before.
  [[nodiscard]] bool made() const noexcept { return made_; }

  /// Whether a path leads to the file that is held.
  [[nodiscard]] bool is_at(const std::filesystem::path& path) const noexcept;

  /// Removes a file that was made here and is still there: it has become no map.
  void remove_made(const std::filesystem::path& path) const noexcept;

 private:
  [[nodiscard]] bool open(const std::filesystem::path& path, int more) noexcept;

  int descriptor_ = -1;
  bool made_ = false;
};

/// Writes down who this is, for whoever comes second.
void sign(Database& database);

}  // namespace seqloop::sqlite
