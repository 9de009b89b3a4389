// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "experiment/report/columns.hpp"
#include "experiment/report/line_styles.hpp"

namespace seqloop::experiment {

struct Point {
  double x;
  double y;
};

/// How many answers a part of the x axis stands for.
struct Count {
  double x;  ///< the middle of the part
  std::uint64_t answers;
};

/// One line of a panel, in the units of its axes.
struct Line {
  std::string name = {};
  std::string value = {};  ///< written before the name
  LineStyle style = {};
  std::vector<Point> points = {};        ///< rising x; empty where there is nothing to draw
  std::vector<std::size_t> breaks = {};  ///< points that nothing leads to from the one before
  std::vector<Point> marks = {};
  std::vector<Count> counts = {};  ///< written under the plot, in a row of their own
  double good = 0.0;               ///< lines are listed by it, best first
};

struct Panel {
  std::string title;
  std::vector<Line> lines;  ///< in the order in which their names are listed
};

struct Axis {
  std::string title;
  Unit unit = Unit::plain;
  double low = 0.0;
  double high = 1.0;  ///< > low
  std::vector<double> ticks = {};
};

/// What a figure draws.
struct Chart {
  Axis x;
  Axis y;
  bool diagonal = false;  ///< where y is x is a line of its own
  std::vector<Panel> panels;
  std::string nothing;  ///< why there is nothing to draw; empty where there is something
  std::string note;     ///< how to read the figure
};

[[nodiscard]] Chart make_chart(const std::vector<Result>& results, const Figure& figure,
                               const LineStyles& styles);

}  // namespace seqloop::experiment
