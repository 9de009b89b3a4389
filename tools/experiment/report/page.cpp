// SPDX-License-Identifier: MIT
#include "experiment/report/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "experiment/report/chart.hpp"
#include "experiment/report/page_style.hpp"
#include "experiment/report/table.hpp"
#include "experiment/report/text.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::experiment {
namespace {

/// Paragraphs, which blank lines part.
std::string paragraphs(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find("\n\n"), text.size());
    const std::string_view paragraph = text.substr(0, end);
    if (paragraph.find_first_not_of(" \n") != std::string_view::npos) {
      html += "<p>" + escaped(paragraph) + "</p>\n";
    }
    text.remove_prefix(std::min(end + 2, text.size()));
  }
  return html;
}

std::string note(std::string_view text) { return "<p class=\"note\">" + escaped(text) + "</p>\n"; }

/// Of each pair, method and descriptor the result with the highest R@100P; then area decides.
Chosen best_results(const Chosen& all) {
  const Names names{"pair", "method", "descriptor"};
  Chosen bests;
  for (const Key& key : keys_of(all, names)) {
    const Result* best = nullptr;
    for (const Result* result : all) {
      if (key_of(*result, names) != key) continue;
      const auto good = [](const Result& r) {
        return std::pair(r.measures.recall_at_100_precision, r.measures.area_under_curve);
      };
      if (best == nullptr || good(*result) > good(*best)) best = result;
    }
    bests.push_back(best);
  }
  return bests;
}

std::string summary(const Chosen& all) {
  if (all.empty()) return note(nothing_to_show({}));
  Table table;
  table.rows = {"pair", "method", "descriptor"};
  table.values = {"recall_at_100_precision",
                  "area_under_curve",
                  "precision",
                  "recall",
                  "accepted_precision",
                  "accepted_recall",
                  "expected_calibration_error",
                  "candidates",
                  "seconds",
                  "speed_up"};
  for (std::string& name : unnamed_differences(all, table.rows)) table.rows.push_back(name);
  // Nobody sees from a method's name over what its R@100P and its area are.
  if (keys_of(all, {"threshold-on"}).size() > 1) table.rows.emplace_back("threshold-on");
  return table_html(
      best_results(all), table,
      "For each method the settings with the highest recall at 100 % precision "
      "(R@100P); of equals those with the larger area under the curve, then those that "
      "come first in the experiment. The best of each pair is bold.",
      Best::bold);
}

std::string figure_html(const Figure& figure, const Chart& chart, std::size_t number,
                        const std::string& file) {
  const std::vector<std::string> panels = panel_svgs(chart);
  const bool full_rows = panels.size() % 3 == 0;
  std::string html = fmt::format(
      "<figure class=\"panels\">\n<figcaption{}>\n<h3>Figure {}. {}</h3>\n{}",
      full_rows ? " class=\"wide\"" : "", number, escaped(figure.title), paragraphs(figure.text));
  html += "<p class=\"note\">" + escaped(chart.nothing.empty() ? chart.note : chart.nothing);
  html += " <a href=\"" + escaped(file) + "\">SVG</a></p>\n</figcaption>\n";
  for (const std::string& panel : panels) html += panel;
  return html + "</figure>\n";
}

std::string table_section(const Table& table, const Chosen& results, std::size_t number) {
  const std::string start =
      fmt::format("<h3>Table {}. {}</h3>\n", number, escaped(table.title)) + paragraphs(table.text);
  if (results.empty()) return start + note(nothing_to_show(table.where));
  Names names = table.rows;
  names.insert(names.end(), table.columns.begin(), table.columns.end());
  const Names more = unnamed_differences(results, names);
  if (more.empty()) return table_html(results, table, start, Best::bold);
  const std::string differences =
      fmt::format("Numbers in one cell differ in {}.", fmt::join(more, ", "));
  return table_html(results, table, start + note(differences), Best::bold);
}

std::string matrix_html(const MatrixPicture& matrix) {
  return fmt::format(
      "<figure>\n<img alt=\"Difference matrix: {0}\" src=\"data:image/png;base64,{1}\"/>\n"
      "<figcaption><strong>{0}</strong>\n{2}</figcaption>\n</figure>\n",
      escaped(matrix.title), base64(matrix.png), paragraphs(matrix.text));
}

std::string all_results(const Chosen& all) {
  Table table;
  table.rows = {"pair", "method", "descriptor"};
  for (std::string& name : setting_names(all)) table.rows.push_back(std::move(name));
  for (const Column& column : number_columns()) table.values.push_back(column.name);
  return fmt::format(
      "<details><summary>{}</summary>\n{}</details>\n", counted(all.size(), "result"),
      table_html(all, table, "Also in <a href=\"results.csv\">results.csv</a>.", Best::plain));
}

std::string conditions(const std::vector<Setting>& list) {
  std::string html = "<dl>\n";
  for (const Setting& item : list) {
    html += "<dt>" + escaped(item.name) + "</dt><dd>" + escaped(item.value) + "</dd>\n";
  }
  return list.empty() ? "<p>not recorded</p>\n" : html + "</dl>\n";
}

std::string head(const Report& report) {
  std::string line;
  for (const Setting& item : report.conditions) {
    if (item.name != "command")
      line += (line.empty() ? "" : " · ") + escaped(item.name + ' ' + item.value);
  }
  return fmt::format(
      "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n{5}\n<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\"/>\n<meta name=\"color-scheme\" content=\"light dark\"/>\n"
      "<title>{0}</title>\n<style>{1}{2}</style>\n</head>\n<body>\n<header>\n<h1>{0}</h1>\n"
      "<p class=\"note\">{3}</p>\n{4}</header>\n<main>\n",
      escaped(report.title), page_style_sheet(), chart_style_sheet(), line, paragraphs(report.text),
      page_mark);
}

std::string section(const char* title, const std::string& content) {
  return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", title, content);
}

}  // namespace

std::string page_html(const Report& report, const std::vector<Chart>& charts,
                      const std::vector<std::string>& figure_files) {
  const Chosen all = choose(report.results, {});
  std::string figures;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    figures += figure_html(report.figures[i], charts[i], i + 1, figure_files[i]);
  }
  std::string tables;
  for (std::size_t i = 0; i < report.tables.size(); ++i) {
    const Table& table = report.tables[i];
    tables += table_section(table, choose(report.results, table.where), i + 1);
  }
  std::string matrices;
  for (const MatrixPicture& matrix : report.matrices) matrices += matrix_html(matrix);
  std::string html = head(report) + section("Summary", summary(all));
  if (!figures.empty()) html += section("Figures", figures);
  if (!tables.empty()) html += section("Tables", tables);
  if (!matrices.empty()) {
    html +=
        section("Difference matrices", note("References downwards, queries to the right.") +
                                           "<div class=\"matrices\">\n" + matrices + "</div>\n");
  }
  html += section("All results", all_results(all));
  if (!report.pairs.empty()) html += section("Pairs of drives", conditions(report.pairs));
  return html + section("Conditions", conditions(report.conditions)) +
         "</main>\n</body>\n</html>\n";
}

}  // namespace seqloop::experiment
