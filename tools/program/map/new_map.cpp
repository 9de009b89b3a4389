// SPDX-License-Identifier: MIT
#include "program/map/new_map.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "files/partial.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::program {

namespace fs = std::filesystem;
namespace {

/// Removes what killed processes left beside partial maps that are removed themselves: a log may be
/// as large as the map.
void remove_abandoned_logs(const fs::path& path) {
  const std::string begin = "." + path.filename().string() + ".partial-";
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  // `recover` works on a copy where the damaged map has a log.
  constexpr std::array tails{"-wal",  "-shm",      "-journal",  //
                             ".copy", ".copy-wal", ".copy-shm", ".copy-journal"};
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    for (const std::string_view tail : tails) {
      if (!name.starts_with(begin) || !name.ends_with(tail)) continue;
      const fs::path map = folder / name.substr(0, name.size() - tail.size());
      std::error_code kept;
      if (!fs::exists(map, kept) && !kept) fs::remove(entry->path(), kept);
    }
  }
}

}  // namespace

NewMap::NewMap(fs::path path) : path_(std::move(path)) {
  const std::string name = path_.string();
  std::error_code error;
  if (fs::exists(fs::symlink_status(path_, error))) {
    throw SetupError({name, "there is such a file already", "choose another name, or remove it"});
  }
  const fs::path folder = fs::absolute(path_, error).parent_path();
  if (!fs::exists(folder, error) && !error) {
    throw SetupError(files::missing_folder(name, folder));
  }
  sqlite::check_nothing_is_left_of_another(path_);
  const files::Partial made = files::make_partial(path_, files::PartialKind::file);
  if (made.descriptor < 0) {
    throw SetupError({name, "cannot be made: " + std::string(std::strerror(errno)),
                      "look at the rights of its folder"});
  }
  remove_abandoned_logs(path_);
  ::close(made.descriptor);  // an empty file becomes a map, and is locked as such
  partial_ = made.path;
}

NewMap::~NewMap() {
  map_.reset();
  if (partial_.empty()) return;
  std::error_code error;
  fs::remove(partial_, error);
  sqlite::remove_what_is_left(partial_);
}

sqlite::MapFile& NewMap::open(const sqlite::MapForm& form) {
  return map_.emplace(sqlite::MapFile::open(partial_, form));
}

void NewMap::make(const std::function<void()>& fill) {
  try {
    fill();
    if (map_) map_->checkpoint();
  } catch (const sqlite::SaveError& error) {
    std::string text = error.what();
    const std::string name = partial_.string();
    for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;) {
      text.replace(at, name.size(), path_.string());
    }
    throw sqlite::SaveError(text);
  }
  map_.reset();
  sqlite::remove_what_is_left(path_);
  const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
  if (::rename(partial_.c_str(), path_.c_str()) != 0) {
    throw files::IoError(path_.string(), std::strerror(errno));
  }
  partial_.clear();
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace seqloop::program
