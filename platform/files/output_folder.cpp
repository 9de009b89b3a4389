// SPDX-License-Identifier: MIT
#include "files/output_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <system_error>
#include <utility>

#include "files/partial.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::files {
namespace {

namespace fs = std::filesystem;

bool on_other_devices(const fs::path& one, const fs::path& other) {
  struct stat first {};
  struct stat second {};
  return ::stat(one.c_str(), &first) == 0 && ::stat(other.c_str(), &second) == 0 &&
         first.st_dev != second.st_dev;
}

/// Everything that was written in a folder reaches the disk. One call, not one for each file: there
/// may be thousands.
void sync(const fs::path& folder, const std::string& name) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int synced = descriptor < 0 ? -1 : ::syncfs(descriptor);
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (synced != 0) throw IoError(name, "cannot be written to the disk: " + reason(error));
}

}  // namespace

OutputFolder::OutputFolder(fs::path path) : path_(std::move(path)) {
  const std::string shown = path_.string();
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(fs::absolute(path_, error), error);
  path_ = whole.has_filename() ? whole : whole.parent_path();
  if (shown.empty() || error || !path_.has_filename())
    throw SetupError(Fault{"output folder '" + shown + "'", "names no folder", "give a name"});
  const fs::path around = path_.parent_path();
  const auto status = fs::symlink_status(path_, error);
  if (fs::exists(status) && !(fs::is_directory(status) && fs::is_empty(path_, error)))
    throw SetupError(Fault{shown, "is there already and is no empty folder",
                           "choose another name or remove it"});
  if (!fs::is_directory(around, error)) throw SetupError(missing_folder(shown, around));
  if (fs::exists(status) && on_other_devices(path_, around))
    throw SetupError(Fault{shown, "is the top of a file system, which cannot be replaced",
                           "name a folder in it"});
  Partial made = make_partial(path_, PartialKind::folder);
  if (made.descriptor < 0)
    throw SetupError(
        Fault{shown, "cannot be created: " + reason(errno), "choose a folder that may be written"});
  partial_ = std::move(made.path);
  lock_ = made.descriptor;
  // What takes a folder's place is as private as the folder was.
  if (fs::exists(status)) fs::permissions(partial_, status.permissions(), error);
}

OutputFolder::~OutputFolder() {
  std::error_code error;
  if (!partial_.empty()) fs::remove_all(partial_, error);
  ::close(lock_);
}

void OutputFolder::write(const std::string& name, std::span<const std::byte> bytes) {
  errno = 0;
  std::ofstream file(partial_ / name, std::ios::binary);
  file.write(static_cast<const char*>(static_cast<const void*>(bytes.data())),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file)
    throw IoError((path_ / name).string(),
                  "cannot be written: " + (errno != 0 ? reason(errno) : "no reason is known"));
}

void OutputFolder::commit() {
  sync(partial_, path_.string());
  if (std::rename(partial_.c_str(), path_.c_str()) != 0)
    throw IoError(path_.string(), "cannot be completed: " + reason(errno));
  partial_.clear();
}

}  // namespace seqloop::files
