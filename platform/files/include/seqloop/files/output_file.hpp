// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace seqloop::files {

/// A write that failed while running (disk full, drive gone). `what()` is `WHAT: WHY`.
class IoError : public std::runtime_error {
 public:
  IoError(const std::string& what, const std::string& why) : runtime_error(what + ": " + why) {}
};

/// A file that appears under its name only when it is complete.
///
/// Until `commit` everything goes to `.NAME.partial-PID` in the same folder; the destructor removes
/// that file if there was no commit. A process that is killed leaves it behind, and whoever writes
/// the same output next removes it: a lock tells what is left over from what somebody writes. A
/// name that exists and is no regular file (/dev/null, a pipe), and any name in /dev, /proc or
/// /sys, is written directly; `-` and /dev/stdout are the standard output. A symbolic link is
/// followed, so that the file it points to is replaced and not the link.
class OutputFile {
 public:
  /// Throws SetupError: the folder is missing or not writable, the name is a folder, a file that
  /// may not be written.
  explicit OutputFile(std::filesystem::path path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  OutputFile(OutputFile&&) = delete;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  /// Appends. Throws IoError. Allocates: never (64 KiB are taken at construction).
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }

  /// Replaces bytes from the start of the file on, which were written before; the place at which
  /// `write` goes on stays. Throws IoError (a pipe cannot do it).
  void overwrite_start(std::span<const std::byte> bytes);

  /// Hands what is buffered to the system, so that readers of a pipe see it. Throws IoError.
  void flush();

  /// Everything to the disk, then under its own name, replacing what was there. The last call.
  /// Throws IoError.
  void commit();

  /// After a flush that failed: keeps what was flushed before it, as `NAME.incomplete`, and nothing
  /// of what the disk took a part of.
  /// @return that name; empty where nothing is kept: the file is written directly, or cannot be
  ///   renamed. The last call.
  std::filesystem::path keep_incomplete() noexcept;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  /// From now on, a pipe that nobody reads is not waited for without end: `give_up` is asked every
  /// 50 ms, and once it says so, writing throws IoError.
  void heed(bool (*give_up)() noexcept) noexcept { give_up_ = give_up; }

  /// Whether `overwrite_start` works and means this file's own start: not in a pipe, and not in a
  /// standard output that appends or has been written before. To be asked before the first write.
  [[nodiscard]] bool rewindable() const noexcept;

 private:
  void open_beside();
  void wait_for_reader() const;
  [[nodiscard]] std::string name() const;

  std::filesystem::path path_;
  std::filesystem::path partial_;  ///< empty when the file is written directly
  std::vector<std::byte> buffer_;
  std::size_t buffered_ = 0;  ///< bytes of buffer_ in use
  std::uint64_t whole_ = 0;   ///< bytes of the file up to the last flush that did not fail
  int descriptor_ = -1;
  bool (*give_up_)() noexcept = nullptr;
};

/// Removes from a folder what killed processes left of any output file, as far as no process holds
/// it. For folders in which nobody else has files of such names.
void remove_abandoned(const std::filesystem::path& folder);

}  // namespace seqloop::files
