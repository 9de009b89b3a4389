// SPDX-License-Identifier: MIT
#include "experiment/run/section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "program/drives/drives.hpp"
#include "program/options/matcher_settings.hpp"

namespace seqloop::experiment {
namespace {

/// A value as settings have it.
std::string plain(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  if (const auto* decimal = node.as_floating_point()) return fmt::format("{}", decimal->get());
  return {};
}

/// What a value in `where` stands for: a flag is written in two ways.
std::vector<std::string> meant(const toml::node& node) {
  if (const auto* flag = node.as_boolean()) {
    return flag->get() ? std::vector<std::string>{"true", "on"}
                       : std::vector<std::string>{"false", "off"};
  }
  return {plain(node)};
}

}  // namespace

void Section::refuse(const std::string& why, const std::string& remedy) const {
  faults_.push_back({where(), why, remedy});
}

std::string Section::name(const char* kind, const Names& taken) const {
  const toml::node* node = table_.get("name");
  const auto* name = node == nullptr ? nullptr : node->as_string();
  if (name == nullptr || name->get().empty()) {
    refuse(fmt::format("a [[{}]] without a name", kind), "name = \"…\"");
    return {};
  }
  if (std::ranges::find(taken, name->get()) != taken.end()) {
    refuse(fmt::format("there is a [[{}]] '{}' already", kind, name->get()));
  }
  return name->get();
}

Names Section::names(const char* key) const {
  const toml::node* node = table_.get(key);
  return node == nullptr ? Names{} : program::read_names(*node, file_, key, faults_);
}

Names Section::references(const char* key, const char* kind, const Names& known) const {
  Names found;
  for (std::string& name : names(key)) {
    if (std::ranges::find(known, name) != known.end()) {
      const bool twice = std::ranges::find(found, name) != found.end();
      if (twice) refuse(fmt::format("'{}' names '{}' twice", key, name));
      found.push_back(std::move(name));
      continue;
    }
    const std::string meant = program::nearest(name, known);
    faults_.push_back({program::where(file_, *table_.get(key)),
                       fmt::format("there is no [[{}]] '{}'", kind, name),
                       meant.empty() ? "" : "did you mean '" + meant + "'?"});
  }
  return found;
}

std::vector<Setting> Section::set_all(const program::OptionTable& options,
                                      const Names& others) const {
  const auto found = read_options(table_, file_, options, {.ignored = others}, faults_);
  std::vector<Setting> settings;
  settings.reserve(found.size());
  for (const program::WrittenOption& each : found) {
    settings.push_back({each.option->name, each.values.front()});
  }
  set(options, found, settings);
  return settings;
}

std::vector<program::WrittenOption> Section::written(const program::OptionTable& options,
                                                     const Names& others) const {
  return read_options(table_, file_, options, {.ignored = others, .lists = true}, faults_);
}

void Section::set(const program::OptionTable& options,
                  const std::vector<program::WrittenOption>& written,
                  const std::vector<Setting>& chosen) const {
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const program::WrittenOption own{
        options.find(chosen[i].name), written[i].key, written[i].where, {}};
    for (Fault& fault : program::set_written(own, chosen[i].value)) {
      faults_.push_back(std::move(fault));
    }
  }
}

void Section::check_setting(const std::string& name) const {
  Names known{"pair", "method", "descriptor", "algorithm", "kind", "threshold-on"};
  program::MatcherSettings matcher;
  program::DriveSettings drive;
  program::OptionTable options;
  add_matcher_options(options, matcher);
  add_drive_options(options, drive);
  for (const program::Option& option : options.options()) known.push_back(option.name);
  if (std::ranges::find(known, name) != known.end()) return;
  const std::string meant = program::nearest(name, known);
  refuse("'" + name + "' is no setting of a method or a descriptor",
         meant.empty() ? "" : "did you mean '" + meant + "'?");
}

std::vector<Filter> Section::filters() const {
  const toml::node* node = table_.get("where");
  if (node == nullptr) return {};
  const toml::table* where = node->as_table();
  if (where == nullptr) {
    refuse("'where' must be a table");
    return {};
  }
  std::vector<Filter> filters;
  for (const auto& [key, value] : *where) {
    Filter filter{std::string(key.str()), {}};
    const auto add = [&](const toml::node& each) {
      for (std::string& text : meant(each)) filter.values.push_back(std::move(text));
    };
    if (const toml::array* list = value.as_array()) {
      for (const toml::node& element : *list) add(element);
    } else {
      add(value);
    }
    check_setting(filter.name);
    filters.push_back(std::move(filter));
  }
  return filters;
}

std::vector<std::vector<Setting>> Section::combinations(
    const std::vector<program::WrittenOption>& written) const {
  constexpr std::size_t most = 10'000;
  std::vector<std::vector<Setting>> all{{}};
  for (const program::WrittenOption& option : written) {
    std::vector<std::vector<Setting>> longer;
    for (const auto& chosen : all) {
      for (const std::string& value : option.values) {
        longer.push_back(chosen);
        longer.back().push_back({option.option->name, value});
      }
    }
    all = std::move(longer);
    if (all.size() > most) {
      refuse(fmt::format("its lists make more than {} combinations", most), "shorten them");
      return {};
    }
  }
  return all;
}

}  // namespace seqloop::experiment
