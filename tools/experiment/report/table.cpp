// SPDX-License-Identifier: MIT
#include "experiment/report/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "experiment/report/columns.hpp"
#include "experiment/report/text.hpp"

namespace seqloop::experiment {
namespace {

/// A table, laid out.
struct Grid {
  const Table& table;
  std::vector<Column> values;
  std::vector<Key> rows;
  std::vector<Key> columns;
  std::map<std::pair<Key, Key>, Chosen> cells;
  std::size_t first_level;  ///< of the row names that has a column; the ones before are headings
  bool stacked;             ///< a cell's values are below each other, in rows of their own

  [[nodiscard]] std::size_t values_down() const { return stacked ? values.size() : 1; }
  [[nodiscard]] std::size_t values_across() const { return stacked ? 1 : values.size(); }
  /// One value under named columns is named in the caption instead.
  [[nodiscard]] bool values_in_header() const {
    return !stacked && (values.size() > 1 || table.columns.empty());
  }
};

/// The best number of each measure, among results of one pair in one column; as it is shown.
using Bests = std::map<std::tuple<std::string, Key, std::string>, std::string>;

Grid make_grid(const Chosen& results, const Table& table) {
  constexpr std::size_t most_across = 12;
  Grid grid{table, {}, keys_of(results, table.rows), keys_of(results, table.columns), {}, 0, false};
  if (table.rows.size() > 1 && table.rows.front() == "pair") grid.first_level = 1;
  for (const std::string& name : table.values) grid.values.push_back(column_named(name));
  for (const Result* result : results) {
    grid.cells[{key_of(*result, table.rows), key_of(*result, table.columns)}].push_back(result);
  }
  grid.stacked = grid.columns.size() > 1 && grid.values.size() > 1 &&
                 grid.columns.size() * grid.values.size() > most_across;
  return grid;
}

Bests find_bests(const Chosen& results, const Grid& grid) {
  std::map<std::tuple<std::string, Key, std::string>, std::vector<double>> numbers;
  for (const Result* result : results) {
    for (const Column& value : grid.values) {
      const double number = number_of(*result, value.name);
      if (value.better == Better::neither || std::isnan(number)) continue;
      if (value.unit == Unit::seconds && !result->alone) continue;  // others slowed it down
      numbers[{result->pair, key_of(*result, grid.table.columns), value.name}].push_back(number);
    }
  }
  Bests bests;
  for (const auto& [place, list] : numbers) {
    const auto [least, most] = std::ranges::minmax(list);
    const Column column = column_named(std::get<2>(place));
    if (least == most) continue;
    bests[place] = shown(column.unit, column.better == Better::more ? most : least);
  }
  return bests;
}

/// How many keys from `at` on share its first `length` values; 0 where the one before it does too.
std::size_t run_of(const std::vector<Key>& keys, std::size_t at, std::size_t length) {
  const auto same = [&](std::size_t i) {
    return std::equal(keys[i].begin(), keys[i].begin() + static_cast<std::ptrdiff_t>(length),
                      keys[at].begin());
  };
  if (at > 0 && same(at - 1)) return 0;
  std::size_t end = at;
  while (end < keys.size() && same(end)) ++end;
  return end - at;
}

/// @param scope with any other attributes
std::string header_cell(const char* scope, const char* direction, std::size_t count,
                        const std::string& text) {
  const std::string span = count > 1 ? fmt::format(" {}span=\"{}\"", direction, count) : "";
  return fmt::format("<th scope={}{}>{}</th>", scope, span, escaped(text));
}

std::string header(const Grid& grid) {
  constexpr const char* of_numbers = "\"col\" class=\"n\"";
  const Names& names = grid.table.columns;
  const std::size_t lines = names.size() + (grid.values_in_header() ? 1 : 0);
  std::string html = "<thead>\n<tr>";
  for (std::size_t level = grid.first_level; level < grid.table.rows.size(); ++level) {
    html += header_cell("\"col\"", "row", lines, grid.table.rows[level]);
  }
  if (grid.stacked) html += header_cell("\"col\"", "row", lines, "measure");
  for (std::size_t level = 0; level < names.size(); ++level) {
    if (level > 0) html += "<tr>";
    for (std::size_t i = 0; i < grid.columns.size(); ++i) {
      const std::size_t run = run_of(grid.columns, i, level + 1);
      const std::string words = in_words({names[level]}, {grid.columns[i][level]});
      if (run > 0) html += header_cell(of_numbers, "col", run * grid.values_across(), words);
    }
    html += "</tr>\n";
  }
  if (!grid.values_in_header()) return html + "</thead>\n";
  if (!names.empty()) html += "<tr>";
  for (std::size_t i = 0; i < grid.columns.size(); ++i) {
    for (const Column& value : grid.values) html += header_cell(of_numbers, "col", 1, value.title);
  }
  return html + "</tr>\n</thead>\n";
}

std::string cell(const Grid& grid, const Key& row, const Key& column, const Column& value,
                 const Bests& bests) {
  const auto results = grid.cells.find({row, column});
  if (results == grid.cells.end()) return "<td></td>";
  std::string html;
  for (const Result* result : results->second) {
    const std::string text = shown(value.unit, number_of(*result, value.name));
    const auto best = bests.find({result->pair, column, value.name});
    const bool bold = best != bests.end() && best->second == text;
    html += (html.empty() ? "" : "<br/>") + (bold ? "<b>" + text + "</b>" : text);
  }
  return "<td>" + html + "</td>";
}

std::string row_heads(const Grid& grid, std::size_t row) {
  std::string html;
  for (std::size_t level = grid.first_level; level < grid.table.rows.size(); ++level) {
    const std::size_t run = run_of(grid.rows, row, level + 1);
    const std::string& text = grid.rows[row][level];
    if (run > 0) html += header_cell("\"row\"", "row", run * grid.values_down(), text);
  }
  return html;
}

/// A heading over rows of one pair.
std::string group_head(const Grid& grid, std::size_t row) {
  const std::size_t width = grid.table.rows.size() - grid.first_level + (grid.stacked ? 1 : 0) +
                            grid.columns.size() * grid.values_across();
  return "<tr class=\"group\">" +
         header_cell("\"rowgroup\"", "col", width, grid.rows[row].front()) + "</tr>\n";
}

std::string row_html(const Grid& grid, std::size_t row, std::size_t line, const Bests& bests) {
  const std::size_t level = std::min(grid.first_level + 1, grid.table.rows.size());
  const bool first = line == 0 && (level == 0 || run_of(grid.rows, row, level) > 0);
  std::string html = first ? "<tr class=\"first\">" : "<tr>";
  if (line == 0) html += row_heads(grid, row);
  if (grid.stacked) html += header_cell("\"row\"", "row", 1, grid.values[line].title);
  for (const Key& column : grid.columns) {
    for (std::size_t i = 0; i < grid.values_across(); ++i) {
      const Column& value = grid.values[grid.stacked ? line : i];
      html += cell(grid, grid.rows[row], column, value, bests);
    }
  }
  return html + "</tr>\n";
}

std::string body(const Grid& grid, const Bests& bests) {
  std::string html = "<tbody>\n";
  for (std::size_t row = 0; row < grid.rows.size(); ++row) {
    if (grid.first_level > 0 && run_of(grid.rows, row, 1) > 0) {
      html += (row > 0 ? "</tbody>\n<tbody>\n" : "") + group_head(grid, row);
    }
    for (std::size_t line = 0; line < grid.values_down(); ++line) {
      html += row_html(grid, row, line, bests);
    }
  }
  return html + "</tbody>\n";
}

}  // namespace

std::string table_html(const Chosen& results, const Table& table, const std::string& caption,
                       Best best) {
  const Grid grid = make_grid(results, table);
  const Bests bests = best == Best::bold ? find_bests(results, grid) : Bests();
  const bool name_value = !grid.values_in_header() && grid.values.size() == 1;
  const std::string value =
      name_value
          ? "<p class=\"note\">In the cells: " + escaped(grid.values.front().title) + "</p>\n"
          : "";
  return "<div class=\"scroll\" tabindex=\"0\"><table>\n<caption><div>" + caption + value +
         "</div></caption>\n" + header(grid) + body(grid, bests) + "</table></div>\n";
}

}  // namespace seqloop::experiment
