// SPDX-License-Identifier: MIT
#include "experiment/run/shown_sections.hpp"

#include <algorithm>

#include "experiment/report/columns.hpp"

namespace seqloop::experiment {
namespace {

void check_column(const Section& section, const std::string& name) {
  Names known;
  for (const Column& column : number_columns()) known.push_back(column.name);
  if (std::ranges::find(known, name) != known.end()) return;
  const std::string meant = program::nearest(name, known);
  section.refuse("'" + name + "' is no measure",
                 meant.empty() ? "take a column of results.csv" : "did you mean '" + meant + "'?");
}

}  // namespace

Figure read_figure(const Section& section) {
  Figure figure;
  std::string kind = "precision-recall";
  program::OptionTable options;
  options.text("title", figure.title, "");
  options.text("text", figure.text, "");
  options.text("kind", kind, "");
  options.text("panel", figure.panel, "");
  options.text("x", figure.x, "");
  options.text("y", figure.y, "");
  section.set_all(options, {"line", "where"});
  figure.line = section.names("line");
  if (figure.line.empty()) figure.line = {"method"};
  figure.where = section.filters();
  if (kind == "measure") {
    figure.kind = FigureKind::measure;
    if (figure.x.empty() || figure.y.empty()) section.refuse("a figure of a measure needs x and y");
  } else if (kind == "reliability") {
    figure.kind = FigureKind::reliability;
  } else if (kind != "precision-recall") {
    section.refuse("'" + kind + "' is none of precision-recall, reliability, measure");
  }
  if (!figure.y.empty()) check_column(section, figure.y);
  if (!figure.panel.empty()) section.check_setting(figure.panel);
  if (!figure.x.empty()) section.check_setting(figure.x);
  for (const std::string& name : figure.line) section.check_setting(name);
  return figure;
}

Table read_table(const Section& section) {
  Table table;
  program::OptionTable options;
  options.text("title", table.title, "");
  options.text("text", table.text, "");
  section.set_all(options, {"rows", "columns", "values", "where"});
  table.rows = section.names("rows");
  table.columns = section.names("columns");
  table.values = section.names("values");
  table.where = section.filters();
  if (table.rows.empty() || table.values.empty()) section.refuse("a table needs rows and values");
  for (const std::string& value : table.values) check_column(section, value);
  for (const std::string& name : table.rows) section.check_setting(name);
  for (const std::string& name : table.columns) section.check_setting(name);
  return table;
}

}  // namespace seqloop::experiment
