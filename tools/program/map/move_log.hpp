// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// Makes a map that is done one file, as far as nobody reads it.
/// @return why the log has to stay beside it, for a person; nothing: it can go
[[nodiscard]] std::optional<std::string> move_log_into(sqlite::MapFile& map);

}  // namespace seqloop::program
