// SPDX-License-Identifier: MIT
#include "program/process/outputs.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "program/process/database_file.hpp"
#include "seqloop/bags/bag.hpp"
#include "seqloop/opencv/image_folder_source.hpp"

namespace seqloop::program {
namespace {

namespace fs = std::filesystem;

/// What a name stands for.
struct Target {
  explicit Target(const fs::path& path) {
    std::error_code error;
    const bool standard_output = path == "-" || path == "/dev/stdout";
    name = standard_output ? "/dev/stdout" : fs::weakly_canonical(fs::absolute(path, error), error);
    // What cannot be looked up is told apart as it is written.
    if (error) name = fs::absolute(path, error).lexically_normal();
    if (!name.has_filename()) name = name.parent_path();
    struct stat found {};
    const bool there =
        standard_output ? ::fstat(STDOUT_FILENO, &found) == 0 : ::stat(path.c_str(), &found) == 0;
    if (there) status = found;
  }

  /// Devices hold nothing that could be lost: they are the same where their names are.
  [[nodiscard]] bool known_by_number() const { return status && !S_ISCHR(status->st_mode); }
  [[nodiscard]] bool is_folder() const { return status && S_ISDIR(status->st_mode); }

  fs::path name;                      ///< without links, as far as it is there
  std::optional<struct stat> status;  ///< none: nothing is there yet
};

bool same(const Target& one, const Target& other) {
  if (one.known_by_number() && other.known_by_number()) {
    return one.status->st_dev == other.status->st_dev && one.status->st_ino == other.status->st_ino;
  }
  return one.name == other.name;
}

/// Whether something that a drive's folder holds is a part of the drive.
bool is_of_a_drive(const fs::path& entry) {
  return opencv::has_image_extension(entry) || bags::is_bag(entry) ||
         entry.filename() == "metadata.yaml";
}

/// Whether a folder that is read holds a file, by this name or another. Of a drive only what is a
/// part of it is read.
bool lies_in(const Target& file, const FileUse& read) {
  if (!file.known_by_number() || file.is_folder()) return false;
  const fs::path& folder = read.path;
  constexpr std::array drives{"source", "reference", "query", "training"};
  const bool drive = std::ranges::find(drives, read.flag) != drives.end();
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (drive && !is_of_a_drive(entry->path())) continue;
    struct stat found {};
    if (::stat(entry->path().c_str(), &found) == 0 && found.st_dev == file.status->st_dev &&
        found.st_ino == file.status->st_ino) {
      return true;
    }
  }
  return false;
}

/// Why an output is in the way of something else; nothing where it is not.
std::optional<Fault> clash(const FileUse& output, const FileUse& other) {
  const Target target(output.path);
  const Target there(other.path);
  if (other.access != Access::reads) {
    const bool folders = output.access == Access::fills && other.access == Access::fills;
    if (folders || !same(target, there)) return std::nullopt;
    return Fault{output.flag, "is the same file as --" + other.flag, "name another one"};
  }
  if (output.access == Access::fills) {
    if (!there.is_folder() || !same(target, there)) return std::nullopt;
    return Fault{output.flag,
                 fmt::format("files would come among those of {}, which is read ({})",
                             output.path.string(), other.flag),
                 "choose another folder"};
  }
  if (!same(target, there) && !lies_in(target, other)) {
    const bool in_drive = there.is_folder() && target.name.parent_path() == there.name;
    if (!in_drive || !(opencv::has_image_extension(output.path) || bags::is_bag(output.path)))
      return std::nullopt;
    return Fault{output.flag,
                 fmt::format("{} would be read as a part of {} the next time ({})",
                             output.path.string(), other.path.string(), other.flag),
                 "choose another name"};
  }
  return Fault{
      output.flag,
      fmt::format("writing {} would destroy an input ({})", output.path.string(), other.flag),
      "choose another name"};
}

/// Why an output is in the way of a map; nothing where it is not. While a map is written, files
/// with such names belong to it.
std::optional<Fault> clash_with_map(const FileUse& output, const std::vector<FileUse>& uses) {
  for (const std::string_view tail : {"-wal", "-shm", "-journal"}) {
    const std::string name = output.path.string();
    if (!name.ends_with(tail)) continue;
    const fs::path map = name.substr(0, name.size() - tail.size());
    const bool is_named = std::ranges::any_of(uses, [&map](const FileUse& use) {
      return use.flag == "map" && same(Target(use.path), Target(map));
    });
    if (!is_named && !is_database(map)) continue;
    return Fault{output.flag,
                 fmt::format("{} belongs to the map {}: it keeps there what is not in it yet", name,
                             map.string()),
                 "choose another name"};
  }
  return std::nullopt;
}

}  // namespace

void refuse_overwriting(Faults& faults, const std::vector<FileUse>& uses) {
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i].access == Access::reads || uses[i].path.empty()) continue;
    if (std::optional<Fault> fault = clash_with_map(uses[i], uses)) {
      faults.push_back(std::move(*fault));
      continue;
    }
    for (std::size_t k = 0; k < uses.size(); ++k) {
      // Of two outputs the one that is named last is the one to change.
      const bool told_of = uses[k].access != Access::reads && k >= i;
      if (told_of || uses[k].path.empty()) continue;
      if (std::optional<Fault> fault = clash(uses[i], uses[k])) {
        faults.push_back(std::move(*fault));
        break;
      }
    }
  }
}

void check_folder(Faults& faults, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(folder, error);
  while (!std::filesystem::exists(there, error) && there.has_relative_path()) {
    there = there.parent_path();
  }
  if (!std::filesystem::is_directory(there, error)) {
    faults.push_back({folder.string(), there.string() + " is not a folder"});
  } else if (::access(there.c_str(), W_OK) != 0) {
    faults.push_back({folder.string(), there.string() + " may not be written"});
  }
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw SetupError(Fault{folder.string(), "cannot be made: " + error.message()});
}

}  // namespace seqloop::program
