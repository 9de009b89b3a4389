// SPDX-License-Identifier: MIT
#include "program/map/merge.hpp"

#include "program/map/new_map.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {

std::vector<std::uint64_t> merge_maps(const std::vector<std::filesystem::path>& maps,
                                      const std::filesystem::path& out,
                                      const std::function<void()>& between) {
  if (maps.empty()) throw SetupError({"maps", "there is none to merge", "name one or more"});
  NewMap made(out);
  sqlite::MapFile* map = nullptr;
  std::vector<std::uint64_t> added;
  for (const std::filesystem::path& path : maps) {
    between();
    const sqlite::MapFile from = sqlite::MapFile::read_only(path);
    if (map == nullptr) map = &made.open(from.form());
    added.push_back(map->add(from));
  }
  made.commit();
  return added;
}

}  // namespace seqloop::program
