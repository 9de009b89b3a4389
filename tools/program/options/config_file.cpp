// SPDX-License-Identifier: MIT
#include "program/options/config_file.hpp"

#include "files/text_file.hpp"
#include "program/options/toml_options.hpp"
#include "program/options/verb.hpp"

namespace seqloop::program {

Faults apply_config_text(std::string_view text, const std::string& name, const OptionTable& table,
                         const std::set<std::string>& given,
                         const std::vector<std::string>& known) {
  // A table may have a flag's name, as `[run]` has, but is none.
  OtherKeys others;
  others.tables = false;
  for (const std::string& key : known) {
    if (table.find(key) == nullptr) others.ignored.push_back(key);
  }
  Faults faults;
  collect(faults, [&] {
    const toml::table values = parse_toml(text, name);
    for (const WrittenOption& written : read_options(values, name, table, others, faults)) {
      if (given.contains(written.option->name)) continue;
      for (Fault& fault : set_written(written, written.values.front())) {
        faults.push_back(std::move(fault));
      }
    }
  });
  return faults;
}

Faults apply_config_file(const std::filesystem::path& file, const OptionTable& table,
                         const std::set<std::string>& given,
                         const std::vector<std::string>& known) {
  Faults faults;
  collect(faults, [&] {
    faults = apply_config_text(files::read_text(file), file.string(), table, given, known);
  });
  return faults;
}

}  // namespace seqloop::program
