// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "seqloop/fault.hpp"
#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// What to do about a file that is none of an export's.
inline constexpr const char* give_an_export = "name a folder that `seqloop map export` wrote";

/// A session, as an export describes it.
struct DescribedSession {
  std::string name;
  std::int64_t began_ns = 0;
  std::string settings;
  std::uint64_t frames = 0;
  std::optional<sqlite::SavedStatistics> statistics;
};

/// What an export's `map.json` says; where its faults are told, values that are wrong are 0 or
/// empty.
struct DescribedMap {
  sqlite::MapForm form;
  std::optional<std::vector<DescribedSession>> sessions;  ///< nothing: it does not say
};

/// @param faults told of all that is wrong with it
[[nodiscard]] DescribedMap read_map_json(const std::filesystem::path& file, Faults& faults);

}  // namespace seqloop::program
