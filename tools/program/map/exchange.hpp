// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// Writes all that a map holds into a folder, for other programs: `map.json`, `places.csv`,
/// `links.csv`, `session-N.npy` and `thumbnail-PLACE.jpg`. README.md says what is in them.
/// Throws SetupError: damaged, the folder is not empty; IoError.
void export_map(const sqlite::MapFile& map, const std::filesystem::path& folder);

/// Makes a map of such a folder. Throws SetupError: what is missing or does not fit; SaveError.
void import_map(const std::filesystem::path& folder, const std::filesystem::path& out);

}  // namespace seqloop::program
