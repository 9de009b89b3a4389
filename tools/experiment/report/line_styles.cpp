// SPDX-License-Identifier: MIT
#include "experiment/report/line_styles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace seqloop::experiment {
namespace {

/// Chosen by search: far apart for normal, red-blind and green-blind eyes, lines with a contrast of
/// at least 3 against the paper, names of 4.5.
struct Colour {
  const char* line;
  const char* name;
  const char* dark;  ///< both, on dark screens
};

constexpr std::array colours{
    Colour{"#003e9e", "#003e9e", "#4d92b4"}, Colour{"#c8380f", "#c03410", "#ff8010"},
    Colour{"#0b8075", "#0b7a70", "#62e698"}, Colour{"#cb8700", "#8f5f00", "#f3ee30"},
    Colour{"#0a93f5", "#006cbe", "#84d2ff"}, Colour{"#f50fb4", "#cc0f94", "#ff45f5"},
    Colour{"#68344b", "#68344b", "#ff3f80"}, Colour{"#1d1f21", "#1d1f21", "#f4f4f4"}};
constexpr std::array dashes{"none", "7 3", "2 3", "9 3 2 3", "4 2 1 2 1 2"};

constexpr const char* fixed_rules = R"(
.chart { font-family: Arial, "Liberation Sans", Helvetica, sans-serif; font-size: 12px; }
.chart text { fill: #1d1f21; }
.chart .title { font-size: 13px; font-weight: bold; }
.chart .heading { font-size: 16px; font-weight: bold; }
.chart .tick, .chart .axis-title { fill: #5c6167; font-size: 11px; }
.chart .grid { stroke: #e4e7ea; stroke-width: 1; }
.chart .axis { stroke: #8b9197; stroke-width: 1; }
.chart .diagonal { stroke: #a9afb5; stroke-width: 1.4; stroke-dasharray: 1 4; stroke-linecap: round; }
.chart .count { font-size: 10px; }
.chart .paper { fill: #ffffff; }
.chart .curve { fill: none; stroke-width: 1.8; stroke-linejoin: round; stroke-linecap: round; }
.chart .leader { fill: none; stroke-width: 0.7; opacity: 0.55; }
.chart .mark { stroke: #ffffff; stroke-width: 1; }
.chart .value { font-weight: bold; }
.chart .line:hover .curve { stroke-width: 3.5; }
.chart:has(.line:hover) .line:not(:hover) { opacity: 0.2; }
)";
constexpr const char* dark_rules = R"(
.chart text { fill: #eceef0; }
.chart .tick, .chart .axis-title { fill: #a4abb3; }
.chart .grid { stroke: #2b3036; }
.chart .axis { stroke: #737b84; }
.chart .diagonal { stroke: #8b939c; }
.chart .paper { fill: #16191d; }
.chart .mark { stroke: #16191d; }
)";

std::string colour_rules(const char* Colour::*line, const char* Colour::*name) {
  std::string rules;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    rules += fmt::format(
        ".chart .c{0} .curve, .chart .c{0} .leader {{ stroke: {1}; }}\n"
        ".chart .c{0} .mark {{ fill: {1}; }}\n.chart .c{0} text {{ fill: {2}; }}\n",
        i, colours[i].*line, colours[i].*name);
  }
  return rules;
}

/// @return empty where the results are of several methods
std::string method_of(const Chosen& line, const Chosen& all) {
  const auto descriptors = [&](const Chosen& results) {
    std::set<std::string> found;
    for (const Result* result : results) {
      if (result->method == line.front()->method) found.insert(result->descriptor);
    }
    return found;
  };
  const std::string& method = line.front()->method;
  const auto same = [&](const Result* result) { return result->method == method; };
  if (!std::ranges::all_of(line, same)) return {};
  const bool one_of_several = descriptors(line).size() == 1 && descriptors(all).size() > 1;
  return one_of_several ? method + '\n' + line.front()->descriptor : method;
}

/// What each line is known by.
std::map<Key, std::string> identities(const Chosen& results, const Names& line, const Chosen& all) {
  std::map<Key, std::string> known;
  std::set<std::string> different;
  bool telling = true;
  for (const auto& [key, of_line] : grouped(results, line)) {
    known[key] = method_of(of_line, all);
    telling = telling && !known[key].empty() && different.insert(known[key]).second;
  }
  if (telling) return known;
  for (auto& [key, name] : known)
    name = fmt::format("{}\n{}", fmt::join(line, "\n"), fmt::join(key, "\n"));
  return known;
}

}  // namespace

LineStyles::LineStyles(const Report& report) {
  const Chosen all = choose(report.results, {});
  std::vector<std::string> order;
  std::map<std::string, std::set<std::string>> together;  // lines that share a figure
  for (const Figure& figure : report.figures) {
    const Chosen results = choose(report.results, figure.where);
    const auto& lines = figures_[&figure] = identities(results, figure.line, all);
    for (const Key& key : keys_of(results, figure.line)) order.push_back(lines.at(key));
    for (const auto& [key, line] : lines) {
      for (const auto& [other_key, other] : lines) together[line].insert(other);
    }
  }
  for (const std::string& line : order) {
    if (styles_.contains(line)) continue;
    std::set<std::size_t> taken;
    for (const std::string& other : together[line]) {
      if (const auto found = styles_.find(other); found != styles_.end()) {
        taken.insert(found->second);
      }
    }
    std::size_t style = 0;
    while (taken.contains(style)) ++style;
    styles_[line] = style;
  }
}

LineStyle LineStyles::of(const Figure& figure, const Key& line) const {
  const std::size_t style = styles_.at(figures_.at(&figure).at(line));
  return {style % colours.size(), style / colours.size() % dashes.size()};
}

std::string chart_style_sheet() {
  std::string sheet = fixed_rules + colour_rules(&Colour::line, &Colour::name);
  for (std::size_t i = 1; i < dashes.size(); ++i) {
    sheet += fmt::format(".chart .d{} .curve {{ stroke-dasharray: {}; }}\n", i, dashes[i]);
  }
  return sheet + "@media screen and (prefers-color-scheme: dark) {" + dark_rules +
         colour_rules(&Colour::dark, &Colour::dark) + "}\n";
}

}  // namespace seqloop::experiment
