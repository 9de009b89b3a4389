// SPDX-License-Identifier: MIT
#include "program/options/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace seqloop::program {
namespace {

/// Single-letter insertions, deletions and changes from one word to the other.
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

}  // namespace

bool parse_on_off(std::string_view text) {
  if (text == "on") return true;
  if (text == "off") return false;
  throw std::invalid_argument(quoted(text) + " is neither on nor off");
}

std::size_t parse_count(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return value;
  throw std::invalid_argument(quoted(text) + " is no whole number of 0 or more");
}

double parse_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value)) {
    return value;
  }
  throw std::invalid_argument(quoted(text) + " is no number");
}

std::vector<double> parse_numbers(std::string_view text, char separator) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t end = std::min(text.find(separator), text.size());
    numbers.push_back(parse_number(text.substr(0, end)));
    if (end == text.size()) return numbers;
    text.remove_prefix(end + 1);
  }
}

int parse_pixels(std::string_view text, std::size_t least) {
  constexpr std::size_t most = 16'384;
  const std::size_t pixels = parse_count(text);
  if (pixels < least || pixels > most) {
    throw std::invalid_argument(quoted(text) + " is not between " + std::to_string(least) +
                                " and " + std::to_string(most));
  }
  return static_cast<int>(pixels);
}

std::pair<int, int> parse_size(std::string_view text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string_view::npos || text.find('x', cross + 1) != std::string_view::npos) {
    throw std::invalid_argument(quoted(text) + " is not WIDTHxHEIGHT");
  }
  return {parse_pixels(text.substr(0, cross), 1), parse_pixels(text.substr(cross + 1), 1)};
}

void OptionTable::flag(std::string name, bool& target, std::string help) {
  add({std::move(name), ValueKind::flag, std::move(help), [&target](std::string_view value) {
         if (value != "true" && value != "false") {
           throw std::invalid_argument(quoted(value) + " is neither true nor false");
         }
         target = value == "true";
       }});
}

void OptionTable::count(std::string name, std::size_t& target, std::string help) {
  add({std::move(name), ValueKind::count, std::move(help),
       [&target](std::string_view value) { target = parse_count(value); }});
}

void OptionTable::number(std::string name, double& target, std::string help) {
  add({std::move(name), ValueKind::number, std::move(help),
       [&target](std::string_view value) { target = parse_number(value); }});
}

void OptionTable::number(std::string name, float& target, std::string help) {
  add({std::move(name), ValueKind::number, std::move(help),
       [&target](std::string_view value) { target = static_cast<float>(parse_number(value)); }});
}

void OptionTable::text(std::string name, std::string& target, std::string help) {
  add({std::move(name), ValueKind::text, std::move(help),
       [&target](std::string_view value) { target = value; }});
}

void OptionTable::path(std::string name, Access access, std::filesystem::path& target,
                       std::string help) {
  add({name, ValueKind::text, std::move(help),
       [&target](std::string_view value) { target = value; },
       [&target, name, access] {
         return std::vector<FileUse>{{name, access, target}};
       }});
}

void OptionTable::on_off(std::string name, bool& target, std::string help) {
  add({std::move(name), ValueKind::on_off, std::move(help),
       [&target](std::string_view value) { target = parse_on_off(value); }});
}

void OptionTable::folder(const std::string& name, std::filesystem::path& target,
                         std::vector<std::string> files, std::string help) {
  const auto uses = [&target, name, files = std::move(files)] {
    std::vector<FileUse> all;
    if (target.empty()) return all;
    all.push_back({name, Access::fills, target});
    for (const std::string& file : files) all.push_back({name, Access::writes, target / file});
    return all;
  };
  add({name, ValueKind::text, std::move(help),
       [&target](std::string_view value) { target = value; }, uses});
}

std::vector<FileUse> OptionTable::files() const {
  std::vector<FileUse> all;
  for (const Option& option : options_) {
    if (!option.files) continue;
    try {
      for (FileUse& use : option.files()) all.push_back(std::move(use));
    } catch (const SetupError&) {  // whoever opens these files says what is wrong with them
    }
  }
  return all;
}

void OptionTable::add(Option option) {
  option.section = section_;
  option.shown = shown_;
  options_.push_back(std::move(option));
}

void OptionTable::section(std::string heading, Shown shown) {
  section_ = std::move(heading);
  shown_ = shown;
}

const Option* OptionTable::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(options_, name, &Option::name);
  return found == options_.end() ? nullptr : &*found;
}

Fault empty_value(std::string name) {
  return {std::move(name), "its value is empty", "give one, or leave it out"};
}

Faults OptionTable::set(const Option& option, std::string_view value) {
  if (value.empty() && option.kind == ValueKind::text && !option.may_be_bare) {
    return {empty_value(option.name)};
  }
  try {
    option.set(value);
  } catch (const std::invalid_argument& why) {
    return {{option.name, why.what()}};
  } catch (const SetupError& error) {  // of the file that it names
    Faults faults = error.faults();
    for (Fault& fault : faults) fault = {option.name, fault.what + ": " + fault.why, fault.remedy};
    return faults;
  }
  return {};
}

std::string nearest(std::string_view written, const std::vector<std::string>& known) {
  // All that is known is small.
  std::string name(written);
  std::ranges::transform(name, name.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  constexpr std::size_t most_edits = 3;
  std::string best;
  std::size_t fewest = std::min(most_edits, name.size() / 3 + 1) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edits(name, candidate);
    // Of two that are as near, the one that begins alike.
    const bool nearer =
        distance < fewest || (distance == fewest && !best.empty() &&
                              candidate.front() == name.front() && best.front() != name.front());
    if (!nearer) continue;
    fewest = distance;
    best = candidate;
  }
  return best;
}

}  // namespace seqloop::program
