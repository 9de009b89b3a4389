// SPDX-License-Identifier: MIT
#include "program/map/move_log.hpp"

namespace seqloop::program {

std::optional<std::string> move_log_into(sqlite::MapFile& map) {
  try {
    map.checkpoint();
    return std::nullopt;
  } catch (const sqlite::SaveError& error) {
    return map.path().string() +
           "-wal: has to stay beside the map, which is none without it: " + error.what();
  }
}

}  // namespace seqloop::program
