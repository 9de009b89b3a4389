// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace seqloop::test {

/// What was done to a file, or, with `said`, by the test itself.
struct FileEvent {
  enum class What : std::uint8_t { create, write, truncate, sync, remove, said };
  What what;
  std::string file;  ///< its name in the folder
  std::int64_t at =
      0;  ///< where it is written, its new size, whether the folder is synced, or what is said
  std::vector<std::byte> bytes = {};
};

/// While it lives, SQLite reaches files by this: it does what is asked and writes it down.
class RecordingVfs {
 public:
  /// @param start of the names of files that are written down
  explicit RecordingVfs(std::string start);
  RecordingVfs(const RecordingVfs&) = delete;
  RecordingVfs& operator=(const RecordingVfs&) = delete;
  RecordingVfs(RecordingVfs&&) = delete;
  RecordingVfs& operator=(RecordingVfs&&) = delete;
  ~RecordingVfs();

  void say(std::int64_t number) { log.push_back({FileEvent::What::said, "", number}); }

  std::vector<FileEvent> log;
  std::string start;
  bool syncs_reach_the_disk = true;  ///< false: as PRAGMA synchronous = OFF leaves the disk
  /// Asked before a write, truncation or sync. @return 0, or SQLite's code of the error
  std::function<int(FileEvent::What)> refuse;
};

/// The files of a folder, by name.
using DiskImage = std::map<std::string, std::vector<std::byte>>;

/// What a disk may hold if everything ends after some events of a log.
class Disk {
 public:
  /// How it ends.
  enum class End : std::uint8_t { process, power_keeps_synced, power_keeps_some, power_tears };
  static constexpr std::size_t sector = 512;

  void apply(const FileEvent& event);
  [[nodiscard]] DiskImage after(End end, std::uint64_t seed) const;

 private:
  struct File {
    bool named = false;  ///< the folder knows it for good
    bool removed = false;
    bool hides = false;  ///< a removed one of this name, which comes back without the folder
    std::vector<std::byte> hidden = {};
    std::vector<std::byte> synced = {};
    std::vector<FileEvent> pending = {};
  };
  std::map<std::string, File> files_;
};

}  // namespace seqloop::test
