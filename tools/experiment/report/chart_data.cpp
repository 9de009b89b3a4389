// SPDX-License-Identifier: MIT
#include "experiment/report/chart_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace seqloop::experiment {
namespace {

bool finite(const Point& point) { return std::isfinite(point.x) && std::isfinite(point.y); }

Line curve(const Result& result) {
  const evaluation::Measures& measures = result.measures;
  const double recall = measures.recall_at_100_precision;
  Line line{.value = shown(Unit::share, recall)};
  // Down to recall 0 the first point's precision counts, as it does in the area.
  if (!measures.curve.empty()) line.points.push_back({0.0, measures.curve.front().precision});
  for (const evaluation::CurvePoint& point : measures.curve) {
    line.points.push_back({point.recall, point.precision});
  }
  std::erase_if(line.points, [](const Point& point) { return !finite(point); });
  if (recall > 0.0) line.marks.push_back({recall, 1.0});
  constexpr double small = 1e-6;  // the area decides only where recall is equal
  line.good = recall + small * measures.area_under_curve;
  return line;
}

/// Answers of all the results, counted together, each once.
Line reliability_line(const Chosen& results) {
  constexpr std::uint64_t enough = 50;  // answers, for a share of them to mean something
  evaluation::Reliability all{};
  const auto is_copy = [](const Result* result) { return result->is_copy; };
  const bool all_are_copies = std::ranges::all_of(results, is_copy);
  for (const Result* result : results) {
    if (all_are_copies || !is_copy(result)) all = together(all, result->measures.reliability);
  }
  const double error = expected_calibration_error(all);
  Line line{.value = shown(Unit::share, error)};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const evaluation::ReliabilityBin& bin = all[i];
    const double middle = (static_cast<double>(i) + 0.5) / static_cast<double>(all.size());
    line.counts.push_back({middle, bin.count});
    if (bin.count == 0) {
      line.breaks.push_back(line.points.size());
      continue;
    }
    line.points.push_back({bin.mean_probability(), bin.share_right()});
    if (bin.count >= enough) line.marks.push_back(line.points.back());
  }
  line.good = -error;
  return line;
}

Line measure_line(const Chosen& results, const Figure& figure) {
  Line line;
  for (const Result* result : results) {
    const Point point{number_of(*result, figure.x), number_of(*result, figure.y)};
    if (finite(point)) line.points.push_back(point);
  }
  std::ranges::stable_sort(line.points, {}, &Point::x);
  line.marks = line.points;
  line.good = line.points.empty() ? std::nan("") : line.points.back().y;
  line.value = shown(column_named(figure.y).unit, line.good);
  return line;
}

/// A panel's lines of one name: one a result, or one through all of them.
std::vector<Line> lines_of(const Chosen& results, const Figure& figure) {
  std::vector<Line> lines;
  switch (figure.kind) {
    case FigureKind::precision_recall:
      for (const Result* result : results) lines.push_back(curve(*result));
      break;
    case FigureKind::reliability:
      lines.push_back(reliability_line(results));
      break;
    case FigureKind::measure:
      lines.push_back(measure_line(results, figure));
      break;
  }
  for (Line& line : lines) {
    if (std::isnan(line.good)) line.good = -HUGE_VAL;
  }
  return lines;
}

/// What is left of `line` without what all results share or the panel's title says.
Names telling(const Chosen& results, const Figure& figure) {
  Names names;
  for (const std::string& name : figure.line) {
    if (name != figure.panel && keys_of(results, {name}).size() > 1) names.push_back(name);
  }
  return names.empty() ? figure.line : names;
}

Panel make_panel(const Chosen& results, const Figure& figure, const Names& told,
                 const LineStyles& styles) {
  const std::map<Key, Chosen> groups = grouped(results, figure.line);
  Panel panel;
  for (const Key& key : keys_of(results, figure.line)) {
    const Chosen& group = groups.at(key);
    for (Line& line : lines_of(group, figure)) {
      line.name = in_words(told, key_of(*group.front(), told));
      line.style = styles.of(figure, key);
      panel.lines.push_back(std::move(line));
    }
  }
  std::ranges::stable_sort(panel.lines, std::greater<>(), &Line::good);
  return panel;
}

/// Round numbers from 0 to at least `high`.
Axis axis_from_zero(const Column& column, double high) {
  if (column.unit == Unit::share) high = 1.0;
  if (!(high > 0.0)) high = 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(high / 4.0)));
  double step = 10.0 * power;
  for (const double round : {1.0, 2.0, 5.0}) {
    if (high / (round * power) <= 5.0 + 1e-9) {
      step = round * power;
      break;
    }
  }
  Axis axis{.title = column.title, .unit = column.unit};
  const double steps = std::ceil(high / step - 1e-9);
  for (double i = 0.0; i <= steps; ++i) axis.ticks.push_back(i * step);
  axis.high = axis.ticks.back();
  return axis;
}

/// The values that occur, each with a tick.
Axis axis_of_values(const Column& column, const std::vector<Panel>& panels) {
  Axis axis{.title = column.title, .unit = column.unit};
  for (const Panel& panel : panels) {
    for (const Line& line : panel.lines) {
      for (const Point& point : line.points) axis.ticks.push_back(point.x);
    }
  }
  std::ranges::sort(axis.ticks);
  axis.ticks.erase(std::unique(axis.ticks.begin(), axis.ticks.end()), axis.ticks.end());
  if (axis.ticks.empty()) return axis;
  const double room = 0.05 * (axis.ticks.back() - axis.ticks.front());
  axis.low = axis.ticks.front() - (room > 0.0 ? room : 0.5);
  axis.high = axis.ticks.back() + (room > 0.0 ? room : 0.5);
  return axis;
}

void set_axes(Chart& chart, const Figure& figure) {
  if (figure.kind == FigureKind::reliability) {
    chart.x = axis_from_zero({"", "probability said", Unit::share}, 1.0);
    chart.y = axis_from_zero({"", "share right", Unit::share}, 1.0);
    chart.diagonal = true;
    return;
  }
  if (figure.kind == FigureKind::precision_recall) {
    chart.x = axis_from_zero(column_named("recall"), 1.0);
    chart.y = axis_from_zero(column_named("precision"), 1.0);
    return;
  }
  double high = 0.0;
  for (const Panel& panel : chart.panels) {
    for (const Line& line : panel.lines) {
      for (const Point& point : line.points) high = std::max(high, point.y);
    }
  }
  chart.x = axis_of_values(column_named(figure.x), chart.panels);
  chart.y = axis_from_zero(column_named(figure.y), high);
}

const char* how_to_read(FigureKind kind) {
  switch (kind) {
    case FigureKind::precision_recall:
      return "Dots and numbers: the highest recall at which no answer is wrong (R@100P).";
    case FigureKind::reliability:
      return "Answers by tenths of the probability that they were said with; on the grey diagonal, "
             "as many are right as was said. Dots: tenths of 50 answers or more. Numbers before "
             "the "
             "names: the expected calibration error.";
    case FigureKind::measure:
      break;
  }
  return "Numbers: the value at the right end of the line.";
}

/// What a figure does with results that none of its names tells apart.
const char* what_differs(FigureKind kind) {
  switch (kind) {
    case FigureKind::precision_recall:
      return "Lines of one name differ also in";
    case FigureKind::reliability:
      return "Answers are counted together that differ in";
    case FigureKind::measure:
      break;
  }
  return "Points of a line differ also in";
}

std::string note_of(const Chosen& results, const Figure& figure) {
  std::string note = how_to_read(figure.kind);
  Names names = figure.line;
  if (!figure.panel.empty()) names.push_back(figure.panel);
  if (figure.kind == FigureKind::measure) names.push_back(figure.x);
  const Names more = unnamed_differences(results, names);
  if (more.empty()) return note;
  return note + fmt::format(" {} {}.", what_differs(figure.kind), fmt::join(more, ", "));
}

}  // namespace

Chart make_chart(const std::vector<Result>& results, const Figure& figure,
                 const LineStyles& styles) {
  Chart chart;
  const Chosen chosen = choose(results, figure.where);
  if (chosen.empty()) {
    chart.nothing = nothing_to_show(figure.where);
    return chart;
  }
  const Names by = figure.panel.empty() ? Names() : Names{figure.panel};
  const Names told = telling(chosen, figure);
  const std::map<Key, Chosen> groups = grouped(chosen, by);
  for (const Key& key : keys_of(chosen, by)) {
    chart.panels.push_back(make_panel(groups.at(key), figure, told, styles));
    chart.panels.back().title = in_words(by, key);
  }
  set_axes(chart, figure);
  if (chart.x.ticks.empty()) {
    chart.nothing = fmt::format("nothing to show: no result has a number under {} and under {}",
                                figure.x, figure.y);
  }
  chart.note = note_of(chosen, figure);
  return chart;
}

}  // namespace seqloop::experiment
