// SPDX-License-Identifier: MIT
#include "python/open_file.hpp"

#include <unistd.h>

#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::python {
namespace {

struct Files {
  std::mutex mutex;
  std::multiset<std::pair<pid_t, std::filesystem::path>> open;  // by who opened them
};

Files& files() {
  static auto* const all = new Files;  // maps may outlive what is static
  return *all;
}

std::filesystem::path real_name(const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::path name = std::filesystem::weakly_canonical(file, error);
  return error ? file : name;
}

}  // namespace

OpenFile::OpenFile(const std::filesystem::path& file, bool read_only) : file_(real_name(file)) {
  const std::scoped_lock lock(files().mutex);
  if (!read_only && files().open.contains({::getpid(), file_})) {
    throw SetupError({file.string(), "this program has it open already",
                      "close() that PlaceMap; many may read a map (read_only=True)"});
  }
  files().open.emplace(::getpid(), file_);
}

OpenFile::~OpenFile() {
  const std::scoped_lock lock(files().mutex);
  const auto found = files().open.find({::getpid(), file_});
  if (found != files().open.end()) files().open.erase(found);
}

}  // namespace seqloop::python
