// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "seqloop/files/output_file.hpp"

namespace seqloop::files {

/// A folder that appears under its name only when it is complete.
///
/// Until `commit` its files lie in `.NAME.partial-PID` beside it; the destructor removes that
/// folder if there was no commit. A process that is killed leaves it behind, and whoever makes the
/// same folder next removes it. A symbolic link to an empty folder is followed.
class OutputFolder {
 public:
  /// Throws SetupError: there is something under that name already other than an empty folder, the
  /// folder around it is missing or may not be written.
  explicit OutputFolder(std::filesystem::path path);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  OutputFolder(OutputFolder&&) = delete;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();

  /// Makes a file in the folder, or replaces it. Throws IoError.
  void write(const std::string& name, std::span<const std::byte> bytes);
  void write(const std::string& name, std::string_view text) {
    write(name, std::as_bytes(std::span(text)));
  }

  /// Everything to the disk, then under its own name. The last call. Throws IoError.
  void commit();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;  ///< empty after the commit
  int lock_ = -1;                  ///< on that folder
};

}  // namespace seqloop::files
