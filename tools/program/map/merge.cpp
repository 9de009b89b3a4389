// SPDX-License-Identifier: MIT
#include "program/map/merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "program/map/new_map.hpp"
#include "program/options/verb.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {
namespace {

namespace fs = std::filesystem;

std::string kind_of(const sqlite::MapForm& form) {
  return fmt::format("{}, of {} values, described by '{}'", form.form, form.descriptor_size,
                     form.describer);
}

/// Looks at all maps before one is copied, and adds everything that is wrong.
void check_maps(const std::vector<fs::path>& maps, Faults& faults) {
  std::optional<sqlite::MapForm> first;
  for (auto path = maps.begin(); path != maps.end(); ++path) {
    try {
      const sqlite::MapFile map = sqlite::MapFile::read_only(*path);
      if (!first) first = map.form();
      if (map.form() != *first) {
        faults.push_back(
            {path->string(),
             fmt::format(
                 "its places cannot be compared with those of {}: they are {}; those are {}",
                 maps.front().string(), kind_of(map.form()), kind_of(*first)),
             "merge maps that were made with the same settings"});
      }
      const auto same = [&path](const fs::path& other) { return fs::equivalent(other, *path); };
      if (std::any_of(maps.begin(), path, same)) {
        faults.push_back({path->string(), "the same map is named twice", "name it once"});
      }
    } catch (const SetupError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  }
}

}  // namespace

std::vector<std::uint64_t> merge_maps(const std::vector<fs::path>& maps, const fs::path& out,
                                      const std::function<void()>& between) {
  if (maps.empty()) throw SetupError({"maps", "there is none to merge", "name one or more"});
  Faults faults;
  check_maps(maps, faults);
  std::optional<NewMap> made;
  collect(faults, [&] { made.emplace(out); });
  refuse(std::move(faults));
  sqlite::MapFile* map = nullptr;
  std::vector<std::uint64_t> added;
  made->make([&] {
    for (const fs::path& path : maps) {
      between();
      const sqlite::MapFile from = sqlite::MapFile::read_only(path);
      if (map == nullptr) map = &made->open(from.form());
      added.push_back(map->add(from));
    }
  });
  return added;
}

}  // namespace seqloop::program
