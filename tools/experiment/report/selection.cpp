// SPDX-License-Identifier: MIT
#include "experiment/report/selection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "experiment/report/text.hpp"

namespace seqloop::experiment {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& text) {
  return std::ranges::find(list, text) != list.end();
}

bool is_setting(const std::string& name) {
  return name != "pair" && name != "method" && name != "descriptor";
}

/// The different values under a name, in the order of `keys_of`.
std::vector<std::string> values_in_order(const Chosen& results, const std::string& name) {
  std::vector<std::string> values;
  for (const Result* result : results) {
    const std::string value = value_of(*result, name);
    if (!contains(values, value)) values.push_back(value);
  }
  const auto is_number = [](const std::string& text) { return !std::isnan(number_in(text)); };
  if (is_setting(name) && std::ranges::all_of(values, is_number)) {
    std::ranges::stable_sort(values, {}, number_in);
  }
  return values;
}

}  // namespace

Chosen choose(const std::vector<Result>& results, const std::vector<Filter>& where) {
  Chosen chosen;
  for (const Result& result : results) {
    const bool passes = std::ranges::all_of(where, [&](const Filter& filter) {
      return contains(filter.values, value_of(result, filter.name));
    });
    if (passes) chosen.push_back(&result);
  }
  return chosen;
}

std::string nothing_to_show(const std::vector<Filter>& where) {
  if (where.empty()) return "nothing to show: there are no results";
  std::vector<std::string> wanted;
  wanted.reserve(where.size());
  for (const Filter& filter : where) {
    wanted.push_back(fmt::format("{} {}", filter.name, fmt::join(filter.values, " or ")));
  }
  return fmt::format("nothing to show: no result has {}", fmt::join(wanted, " and "));
}

Names setting_names(const Chosen& results) {
  Names names;
  for (const Result* result : results) {
    for (const Setting& setting : result->settings) {
      if (!contains(names, setting.name)) names.push_back(setting.name);
    }
  }
  return names;
}

Key key_of(const Result& result, const Names& names) {
  Key key;
  for (const std::string& name : names) key.push_back(value_of(result, name));
  return key;
}

std::map<Key, Chosen> grouped(const Chosen& results, const Names& names) {
  std::map<Key, Chosen> groups;
  for (const Result* result : results) groups[key_of(*result, names)].push_back(result);
  return groups;
}

std::vector<Key> keys_of(const Chosen& results, const Names& names) {
  std::vector<std::vector<std::string>> orders;
  orders.reserve(names.size());
  for (const std::string& name : names) orders.push_back(values_in_order(results, name));
  std::map<std::vector<std::ptrdiff_t>, Key> sorted;
  for (const Result* result : results) {
    Key key = key_of(*result, names);
    std::vector<std::ptrdiff_t> rank;
    for (std::size_t i = 0; i < key.size(); ++i) {
      rank.push_back(std::ranges::find(orders[i], key[i]) - orders[i].begin());
    }
    sorted.emplace(std::move(rank), std::move(key));
  }
  std::vector<Key> keys;
  keys.reserve(sorted.size());
  for (auto& [rank, key] : sorted) keys.push_back(std::move(key));
  return keys;
}

Names unnamed_differences(const Chosen& results, const Names& names) {
  Names candidates{"pair", "method", "descriptor"};
  for (std::string& name : setting_names(results)) candidates.push_back(std::move(name));
  std::map<Key, const Result*> first;
  Names differing;
  for (const Result* result : results) {
    const Result& other = *first.emplace(key_of(*result, names), result).first->second;
    for (const std::string& name : candidates) {
      if (value_of(*result, name) == value_of(other, name) || contains(differing, name)) continue;
      differing.push_back(name);
    }
  }
  return differing;
}

std::string in_words(const Names& names, const Key& key) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < key.size(); ++i) {
    if (key[i].empty()) continue;
    words.push_back(is_setting(names[i]) ? names[i] + ' ' + key[i] : key[i]);
  }
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace seqloop::experiment
