// SPDX-License-Identifier: MIT
#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "program/options/options.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {

/// A key of a TOML table that names an option, with what the command line would say.
struct WrittenOption {
  const Option* option;
  std::string key;                  ///< as the table spells it: `budget-total` or `budget.total`
  std::string where;                ///< FILE:LINE
  std::vector<std::string> values;  ///< one, or as many as a list holds; never none
};

/// What a table may hold beside the options' names.
struct OtherKeys {
  std::vector<std::string> ignored;  ///< somebody else reads them, or nobody
  bool lists = false;                ///< an option may have a list of values
  bool tables = true;                ///< what is ignored may be a table, whatever is in it
};

/// `FILE:LINE` of a node.
[[nodiscard]] std::string where(const std::string& file, const toml::node& node);

/// A string, or a list of strings. @return none, and a fault, for anything else
[[nodiscard]] std::vector<std::string> read_names(const toml::node& node, const std::string& file,
                                                  const std::string& key, Faults& faults);

/// Reads the keys of a table as options, in the order of the file; an inner table's name goes in
/// front with a dash. Adds a fault for each unknown key, with the nearest known one, and for each
/// value of the wrong type.
[[nodiscard]] std::vector<WrittenOption> read_options(const toml::table& table,
                                                      const std::string& file,
                                                      const OptionTable& options,
                                                      const OtherKeys& others, Faults& faults);

/// Takes one value of a written option. @return why not, with the line
[[nodiscard]] Faults set_written(const WrittenOption& written, const std::string& value);

/// Parses TOML. Throws SetupError with the line; a text that is nested too deeply is refused, since
/// the parser and its users recurse once a level.
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& file);

}  // namespace seqloop::program
