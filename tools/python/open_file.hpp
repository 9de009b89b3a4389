// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace seqloop::python {

/// A map's file, as long as this process has it open. A fork of it has not.
class OpenFile {
 public:
  /// Throws SetupError: it is to be written, and this process has it open already, which the map's
  /// file itself would only know as some process.
  OpenFile(const std::filesystem::path& file, bool read_only);
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile();

 private:
  std::filesystem::path file_;
};

}  // namespace seqloop::python
