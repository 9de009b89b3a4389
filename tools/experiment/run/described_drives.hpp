// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "experiment/run/experiment.hpp"
#include "experiment/run/jobs.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop::experiment {

/// The descriptors that an experiment needs, in a folder: each drive described by each descriptor
/// that some run wants of it, but for those that were described elsewhere.
class DescribedDrives {
 public:
  /// @param experiment lives longer
  DescribedDrives(const Experiment& experiment, std::filesystem::path folder);

  /// Opens every drive and every model. Adds what is wrong, with the file's line.
  void check(Faults& faults);

  /// What is not there yet, to be done before anything is asked for.
  [[nodiscard]] std::vector<Job> jobs() const;

  /// Frames of a drive, where that is sure beforehand: what a video declares is not. After `check`.
  [[nodiscard]] std::optional<std::uint64_t> length(const std::string& drive) const;

  /// Frames of a drive, more or less, for what work on it costs. After `check`.
  [[nodiscard]] std::uint64_t about(const std::string& drive) const;

  /// Where the descriptors are. After `check`.
  [[nodiscard]] std::filesystem::path file(const std::string& drive, std::size_t descriptor) const;

  /// What tells them from others, and the drive's pictures, as they were in `check`.
  [[nodiscard]] const std::string& made_from(const std::string& drive,
                                             std::size_t descriptor) const;

  /// The descriptors. Throws SetupError: somebody damaged them.
  [[nodiscard]] files::Matrix read(const std::string& drive, std::size_t descriptor) const;

  /// The drive's frames. Throws SetupError.
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& drive) const;

 private:
  struct Wanted {
    std::string drive;
    std::size_t descriptor;
    bool operator<(const Wanted& other) const {
      return std::tie(drive, descriptor) < std::tie(other.drive, other.descriptor);
    }
  };

  /// Frames of a drive by its source, and whether that is sure.
  struct Declared {
    std::optional<std::uint64_t> frames;
    bool sure = false;
  };

  /// Before stills are taken of it. Throws SetupError.
  static std::unique_ptr<FrameSource> open_whole(const DriveSpec& spec);

  struct Made {
    std::filesystem::path file;
    std::string made_from;
  };

  /// Looks at what was described elsewhere. @param pictures what tells the drive's from others
  /// @return values in a row. Throws SetupError.
  std::size_t look_at(const Wanted& wanted, const std::string& pictures);
  void check_rows(const std::set<Wanted>& wanted, std::map<std::string, std::string>& states,
                  Faults& faults);
  void check_pictures(const std::set<Wanted>& wanted, Faults& faults) const;
  void describe(const Wanted& wanted) const;

  const Experiment& experiment_;
  std::filesystem::path folder_;
  std::map<std::string, Declared> lengths_;
  std::map<Wanted, Made> files_;
};

}  // namespace seqloop::experiment
