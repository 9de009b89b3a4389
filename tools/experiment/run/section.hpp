// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "experiment/report/result.hpp"
#include "program/options/toml_options.hpp"

namespace seqloop::experiment {

using Names = std::vector<std::string>;

/// One `[[section]]` of an experiment file, read piece by piece; what is wrong is added to the
/// faults, with its line.
class Section {
 public:
  /// All of them live longer than the section.
  Section(const toml::table& table, const std::string& file, Faults& faults)
      : table_(table), file_(file), faults_(faults) {}

  [[nodiscard]] std::string where() const { return program::where(file_, table_); }
  [[nodiscard]] bool has(const char* key) const { return table_.get(key) != nullptr; }
  void refuse(const std::string& why, const std::string& remedy = {}) const;

  /// Its name, which no other of its kind may have.
  [[nodiscard]] std::string name(const char* kind, const Names& taken) const;

  /// A string or a list of strings; none when the key is absent.
  [[nodiscard]] Names names(const char* key) const;

  /// Likewise, each the name of a section of some kind.
  [[nodiscard]] Names references(const char* key, const char* kind, const Names& known) const;

  /// Sets options, one value each. @param others keys that are read otherwise @return as written
  std::vector<Setting> set_all(const program::OptionTable& options, const Names& others) const;

  /// The options as they are written, lists of values too.
  [[nodiscard]] std::vector<program::WrittenOption> written(const program::OptionTable& options,
                                                            const Names& others) const;

  /// Every choice of one value for each option; refuses more than 10,000.
  [[nodiscard]] std::vector<std::vector<Setting>> combinations(
      const std::vector<program::WrittenOption>& written) const;

  /// Sets the options of the same names in another table to these values.
  void set(const program::OptionTable& options, const std::vector<program::WrittenOption>& written,
           const std::vector<Setting>& chosen) const;

  /// Refuses a name that no result can have a value under.
  void check_setting(const std::string& name) const;

  /// The table `where`: what a figure or a table shows.
  [[nodiscard]] std::vector<Filter> filters() const;

 private:
  const toml::table& table_;
  const std::string& file_;
  Faults& faults_;
};

}  // namespace seqloop::experiment
