// SPDX-License-Identifier: MIT
#include "experiment/report/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "experiment/report/spread.hpp"
#include "experiment/report/text.hpp"

namespace seqloop::experiment {
namespace {

// Pixels.
constexpr double panel_width = 392.0;
constexpr double title_height = 17.0;
constexpr double axis_title_height = 22.0;  // and room under it
constexpr double plot_bottom = 36.0;        // ticks and the name of the x axis
constexpr double least_height = 196.0;      // of the plot
constexpr double least_width = 150.0;
constexpr double least_width_over_counts = 230.0;
constexpr double counts_title_height = 16.0;
constexpr double label_height = 15.0;
constexpr double font = 12.0;
constexpr double tick_font = 11.0;
constexpr double bold = 1.13;  // times as wide
constexpr double leader_length = 22.0;
constexpr double gap = 24.0;  // between panels

/// Where things are in every panel of a chart.
struct Layout {
  double top;  // of the plot
  double left;
  double right;
  double bottom;
  double value;   // width of the numbers before the names
  double name;    // width of the names
  double counts;  // height of the rows of counts under the plot

  [[nodiscard]] double height() const { return bottom + plot_bottom + counts; }
};

std::string tick_text(const Axis& axis, double value) {
  if (axis.unit != Unit::share) return shown(axis.unit, value);
  const std::string text = fmt::format("{:g}", value);
  return text.starts_with("0.") ? text.substr(1) : text;
}

Layout layout_of(const Chart& chart) {
  double ticks = 0.0;
  for (const double tick : chart.y.ticks) {
    ticks = std::max(ticks, text_width(tick_text(chart.y, tick), tick_font));
  }
  const bool titles =
      std::ranges::any_of(chart.panels, [](const Panel& panel) { return !panel.title.empty(); });
  Layout layout{};
  layout.top = axis_title_height + (titles ? title_height : 0.0);
  layout.left = ticks + 8.0;
  std::size_t most = 0;
  bool counts = false;
  for (const Panel& panel : chart.panels) {
    most = std::max(most, panel.lines.size());
    for (const Line& line : panel.lines) {
      counts = counts || !line.counts.empty();
      layout.value = std::max(layout.value, text_width(line.value, bold * font) + 6.0);
      layout.name = std::max(layout.name, text_width(line.name, font));
    }
  }
  const double beside = panel_width - layout.value - leader_length;
  const double least = counts ? least_width_over_counts : least_width;
  layout.name = std::clamp(beside - layout.left - least, 0.0, layout.name);
  layout.right = beside - layout.name;
  layout.bottom = layout.top + std::max(least_height, static_cast<double>(most) * label_height);
  if (counts) layout.counts = counts_title_height + static_cast<double>(most) * label_height;
  return layout;
}

/// From an axis to pixels.
struct Scale {
  const Axis& axis;
  double from;
  double to;
  [[nodiscard]] double operator()(double value) const {
    return from + (to - from) * (value - axis.low) / (axis.high - axis.low);
  }
};

std::string text_at(double x, double y, const char* attributes, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, attributes,
                     escaped(text));
}

/// Without points that no eye could tell from their neighbours.
std::string path_through(std::span<const Point> pixels) {
  constexpr double same = 0.3;
  std::vector<Point> kept;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Point& point = pixels[i];
    const bool near = !kept.empty() && std::abs(point.x - kept.back().x) < same &&
                      std::abs(point.y - kept.back().y) < same;
    if (near && i + 1 < pixels.size()) continue;
    const std::size_t n = kept.size();
    const bool level = n > 1 && std::abs(point.y - kept[n - 1].y) < 1e-9 &&
                       std::abs(point.y - kept[n - 2].y) < 1e-9;
    if (level) kept.pop_back();
    kept.push_back(point);
  }
  std::string path;
  for (const Point& point : kept) {
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", point.x, point.y);
  }
  return path;
}

/// The parts of a line between its breaks.
std::string path_of(const Line& line, std::span<const Point> pixels) {
  std::string path;
  std::size_t first = 0;
  const auto draw_to = [&](std::size_t end) {
    if (end > first) path += path_through(pixels.subspan(first, end - first));
    first = end;
  };
  for (const std::size_t end : line.breaks) draw_to(end);
  draw_to(pixels.size());
  return path;
}

std::string axes_svg(const Chart& chart, const Scale& x, const Scale& y, bool titles) {
  std::string svg;
  for (const double tick : chart.y.ticks) {
    svg += fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n",
                       tick == chart.y.low ? "axis" : "grid", x.from, y(tick), x.to);
    svg += text_at(x.from - 6.0, y(tick) + 4.0, "class=\"tick\" text-anchor=\"end\"",
                   tick_text(chart.y, tick));
  }
  double free_from = -HUGE_VAL;
  for (const double tick : chart.x.ticks) {
    const std::string text = tick_text(chart.x, tick);
    const double half = text_width(text, tick_font) / 2.0;
    if (x(tick) - half < free_from) continue;
    free_from = x(tick) + half + 4.0;
    svg +=
        fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>\n", x(tick), y.from, y.to);
    svg += text_at(x(tick), y.from + 15.0, "class=\"tick\" text-anchor=\"middle\"", text);
  }
  if (!titles) return svg;
  svg += text_at(0.0, y.to - 11.0, "class=\"axis-title\"", chart.y.title);
  return svg +
         text_at(x.to, y.from + 30.0, "class=\"axis-title\" text-anchor=\"end\"", chart.x.title);
}

std::string line_svg(const Line& line, const Scale& x, const Scale& y, const Layout& layout,
                     double label) {
  std::string svg =
      fmt::format("<g class=\"line c{} d{}\"><title>{} {}</title>\n", line.style.colour,
                  line.style.dash, escaped(line.value), escaped(line.name));
  std::vector<Point> pixels;
  for (const Point& point : line.points) pixels.push_back({x(point.x), y(point.y)});
  const double text = layout.right + leader_length;
  if (!pixels.empty()) {
    svg += fmt::format("<path class=\"leader\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n",
                       pixels.back().x, pixels.back().y, text - 4.0, label);
    svg += fmt::format("<path class=\"curve\" d=\"{}\"/>\n", path_of(line, pixels));
  }
  for (const Point& mark : line.marks) {
    svg += fmt::format("<circle class=\"mark\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>\n",
                       x(mark.x), y(mark.y));
  }
  svg += text_at(text, label + 4.0, "class=\"value\"", line.value);
  svg += text_at(text + layout.value, label + 4.0, "class=\"name\"",
                 shortened(line.name, font, layout.name));
  return svg + "</g>\n";
}

/// `950`, `6.2k`, `12k`: at most four characters up to a million.
std::string short_count(std::uint64_t count) {
  if (count < 1000) return std::to_string(count);
  const double thousands = static_cast<double>(count) / 1000.0;
  return fmt::format("{:.{}f}k", thousands, count < 9950 ? 1 : 0);
}

/// How many answers each part of the x axis stands for, a row a line.
std::string counts_svg(const std::vector<Line>& lines, const Scale& x, const Layout& layout,
                       bool titles) {
  double y = layout.bottom + plot_bottom + counts_title_height - 4.0;
  std::string svg;
  if (titles) svg += text_at(x.from, y, "class=\"axis-title\"", "answers in each tenth");
  for (const Line& line : lines) {
    y += label_height;
    svg += fmt::format("<g class=\"c{}\">\n", line.style.colour);
    for (const Count& count : line.counts) {
      svg += text_at(x(count.x), y, "class=\"count\" text-anchor=\"middle\"",
                     short_count(count.answers));
    }
    svg += text_at(layout.right + leader_length + layout.value, y, "class=\"name\"",
                   shortened(line.name, font, layout.name));
    svg += "</g>\n";
  }
  return svg;
}

std::string panel_content(const Chart& chart, const Panel& panel, const Layout& layout,
                          bool titles) {
  const Scale x{chart.x, layout.left, layout.right};
  const Scale y{chart.y, layout.bottom, layout.top};
  std::vector<double> wanted;
  for (const Line& line : panel.lines) {
    wanted.push_back(line.points.empty() ? layout.bottom : y(line.points.back().y));
  }
  const std::vector<double> labels = spread(wanted, label_height, layout.top, layout.bottom);
  std::string svg =
      text_at(0.0, 13.0, "class=\"title\"", shortened(panel.title, bold * 13.0, panel_width));
  svg += axes_svg(chart, x, y, titles);
  if (chart.diagonal) {
    svg += fmt::format("<path class=\"diagonal\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x.from,
                       y.from, x.to, y.to);
  }
  for (std::size_t i = 0; i < labels.size(); ++i) {
    svg += line_svg(panel.lines[i], x, y, layout, labels[i]);
  }
  if (layout.counts > 0.0) svg += counts_svg(panel.lines, x, layout, titles);
  return svg;
}

/// A panel in words, for those who cannot see it.
std::string description(const Chart& chart, const Panel& panel) {
  std::string words =
      panel.title + (panel.title.empty() ? "" : ": ") + chart.y.title + " over " + chart.x.title;
  for (const Line& line : panel.lines) words += "; " + line.name + ' ' + line.value;
  return words;
}

std::string svg_open(double width, double height, const std::string& label) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "width=\"{0:.0f}\" height=\"{1:.0f}\" role=\"img\" aria-label=\"{2}\">\n",
      width, std::ceil(height), escaped(label));
}

}  // namespace

std::vector<std::string> panel_svgs(const Chart& chart) {
  std::vector<std::string> svgs;
  if (!chart.nothing.empty()) return svgs;
  const Layout layout = layout_of(chart);
  for (const Panel& panel : chart.panels) {
    svgs.push_back(svg_open(panel_width, layout.height(), description(chart, panel)) +
                   panel_content(chart, panel, layout, true) + "</svg>\n");
  }
  return svgs;
}

std::string figure_svg(const Chart& chart, const std::string& title) {
  constexpr std::size_t most_columns = 3;
  constexpr double margin = 16.0;
  constexpr double heading_font = bold * 16.0;
  const std::size_t panels = chart.nothing.empty() ? chart.panels.size() : 0;
  const std::size_t columns = std::clamp<std::size_t>(panels, 1, most_columns);
  const auto place = [](std::size_t i, double size) {
    return margin + static_cast<double>(i) * (size + gap);
  };
  const double width = place(columns, panel_width) - gap + margin;
  std::string content;
  double top = 8.0;
  for (const std::string& line : wrapped(title, heading_font, width - 2.0 * margin)) {
    content += text_at(margin, top += 20.0, "class=\"heading\"", line);
  }
  for (const std::string& line : wrapped(chart.nothing, font, width - 2.0 * margin)) {
    content += text_at(margin, top += 20.0, "", line);
  }
  const Layout layout = layout_of(chart);
  for (std::size_t i = 0; i < panels; ++i) {
    content +=
        fmt::format("<g transform=\"translate({:.1f} {:.1f})\">\n", place(i % columns, panel_width),
                    top + place(i / columns, layout.height()));
    content += panel_content(chart, chart.panels[i], layout, i == 0) + "</g>\n";
  }
  const std::size_t rows = (panels + columns - 1) / columns;
  const double height = top + place(rows, layout.height());
  return svg_open(width, height, title) + "<style>" + chart_style_sheet() + "</style>\n" +
         "<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n" + content + "</svg>\n";
}

}  // namespace seqloop::experiment
