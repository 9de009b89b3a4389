// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "program/options/options.hpp"

namespace seqloop::program {

/// Settings from a TOML file: a key is a flag's name, a table's name goes in front with a dash.
/// @param table  what the subcommand takes; a value of the wrong type is a fault
/// @param given  names that the command line has set already: it wins
/// @param known  names that other subcommands know: one file may serve them all
/// @return every fault: unknown keys with the nearest known one, types, values; or the one that
///   keeps the file from being read
[[nodiscard]] Faults apply_config_file(const std::filesystem::path& file, const OptionTable& table,
                                       const std::set<std::string>& given,
                                       const std::vector<std::string>& known);

/// The same from text that is at hand. @param name the file, for messages
[[nodiscard]] Faults apply_config_text(std::string_view text, const std::string& name,
                                       const OptionTable& table, const std::set<std::string>& given,
                                       const std::vector<std::string>& known);

}  // namespace seqloop::program
