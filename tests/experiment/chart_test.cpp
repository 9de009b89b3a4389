// SPDX-License-Identifier: MIT
#include "experiment/report/chart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "experiment/report/spread.hpp"
#include "experiment/synthetic_result.hpp"

namespace seqloop::experiment {
namespace {

Figure figure(FigureKind kind, std::vector<std::string> line) {
  return {"title", "", kind, "", std::move(line), "ds", "recall", {}};
}

Chart chart_of(const Report& report, std::size_t i) {
  return make_chart(report.results, report.figures[i], LineStyles(report));
}

std::vector<std::string> names(const Panel& panel) {
  std::vector<std::string> all;
  for (const Line& line : panel.lines) all.push_back(line.value + ' ' + line.name);
  return all;
}

TEST(Spread, KeepsOrderGapAndBounds) {
  using Positions = std::vector<double>;
  EXPECT_EQ(spread({}, 10.0, 0.0, 100.0), Positions());
  EXPECT_EQ(spread({7.0}, 10.0, 0.0, 100.0), Positions({7.0}));
  EXPECT_EQ(spread({10.0, 50.0, 90.0}, 10.0, 0.0, 100.0), Positions({10.0, 50.0, 90.0}));
  // Three at one place: the middle one stays.
  EXPECT_EQ(spread({50.0, 50.0, 50.0, 90.0}, 10.0, 0.0, 100.0),
            Positions({40.0, 50.0, 60.0, 90.0}));
  // In the wrong order: they meet half way.
  EXPECT_EQ(spread({60.0, 40.0}, 10.0, 0.0, 100.0), Positions({45.0, 55.0}));
  EXPECT_EQ(spread({0.0, 0.0}, 10.0, 0.0, 100.0), Positions({0.0, 10.0}));
  EXPECT_EQ(spread({99.0, 99.0}, 10.0, 0.0, 100.0), Positions({90.0, 100.0}));
  // No room for all: they begin at the top.
  EXPECT_EQ(spread({5.0, 5.0, 5.0}, 10.0, 0.0, 15.0), Positions({0.0, 10.0, 20.0}));
}

TEST(Chart, DrawsPrecisionOverRecallTheBestFirst) {
  Report report;
  report.results = {synthetic_result("p", "weak", "d", {{"ds", "20"}}, 0.25),
                    synthetic_result("p", "strong", "d", {{"ds", "20"}}, 0.8),
                    synthetic_result("p", "silent", "d", {{"ds", "20"}}, 0.0),
                    synthetic_result("p", "strong", "d", {{"ds", "100"}}, 0.9)};
  report.figures = {figure(FigureKind::precision_recall, {"method", "descriptor"})};
  report.figures[0].panel = "ds";
  const Chart chart = chart_of(report, 0);
  ASSERT_EQ(chart.panels.size(), 2U);
  EXPECT_EQ(chart.panels[0].title, "ds 20");
  EXPECT_EQ(chart.panels[1].title, "ds 100");
  const std::vector<std::string> expected{".800 strong", ".250 weak", ".000 silent"};
  EXPECT_EQ(names(chart.panels[0]), expected);

  const Line& strong = chart.panels[0].lines[0];
  ASSERT_EQ(strong.points.size(), 4U);
  EXPECT_EQ(strong.points[0].x, 0.0);  // the first point's precision, down to recall 0
  EXPECT_EQ(strong.points[0].y, 1.0);
  EXPECT_EQ(strong.points[3].y, 0.75);
  ASSERT_EQ(strong.marks.size(), 1U);
  EXPECT_EQ(strong.marks[0].x, 0.8);
  EXPECT_EQ(strong.marks[0].y, 1.0);
  EXPECT_TRUE(chart.panels[0].lines[2].points.empty());
  EXPECT_TRUE(chart.panels[0].lines[2].marks.empty());
}

TEST(Chart, CountsAnswersOnceThatAreShownUnderTwoNames) {
  Report report;
  report.results = {synthetic_result("p", "m", "d", {}, 0.5),
                    synthetic_result("p", "m (best)", "d", {}, 0.5)};
  for (Result& result : report.results) result.measures.reliability[9] = {100, 90, 90.0};
  report.results[1].is_copy = true;
  report.figures = {figure(FigureKind::reliability, {"descriptor"}),
                    figure(FigureKind::reliability, {"method"})};
  EXPECT_EQ(chart_of(report, 0).panels.at(0).lines.at(0).counts.at(9).answers, 100U);
  const Chart apart = chart_of(report, 1);
  ASSERT_EQ(apart.panels.at(0).lines.size(), 2U);
  for (const Line& line : apart.panels[0].lines) EXPECT_EQ(line.counts.at(9).answers, 100U);
}

TEST(Chart, DrawsHowReliableProbabilitiesAre) {
  Report report;
  report.results = {synthetic_result("p", "bold", "d", {}, 0.5),
                    synthetic_result("p", "honest", "d", {}, 0.5),
                    synthetic_result("p", "mute", "d", {}, 0.5)};
  report.results[0].measures.reliability[9] = {12'345, 6'000, 12'000.0};
  report.results[1].measures.reliability[0] = {10, 1, 0.5};
  report.results[1].measures.reliability[7] = {1000, 750, 750.0};
  report.figures = {figure(FigureKind::reliability, {"method"}),
                    figure(FigureKind::reliability, {"descriptor"})};
  const Chart chart = chart_of(report, 0);
  EXPECT_TRUE(chart.diagonal);
  EXPECT_EQ(names(chart.panels.at(0)),
            (std::vector<std::string>{".000 honest", ".486 bold", "– mute"}));
  const Line& honest = chart.panels[0].lines[0];
  ASSERT_EQ(honest.points.size(), 2U) << "a tenth without answers is no point";
  EXPECT_EQ(honest.points[0].x, 0.05);
  EXPECT_EQ(honest.points[0].y, 0.1);
  ASSERT_EQ(honest.marks.size(), 1U) << "ten answers say little";
  EXPECT_EQ(honest.marks[0].y, 0.75);
  ASSERT_EQ(honest.counts.size(), 10U);
  EXPECT_DOUBLE_EQ(honest.counts[7].x, 0.75);
  EXPECT_EQ(honest.counts[7].answers, 1000U);
  EXPECT_TRUE(chart.panels[0].lines[2].points.empty());
  EXPECT_EQ(chart.panels[0].lines[1].breaks.back(), 0U);
  const std::string svg = figure_svg(chart, "t");
  const std::size_t curve = svg.find("class=\"curve\" d=\"M");
  ASSERT_NE(curve, std::string::npos);
  const std::string path = svg.substr(curve, svg.find("/>", curve) - curve);
  EXPECT_EQ(std::ranges::count(path, 'M'), 2) << path << ": six empty tenths lie between";
  EXPECT_EQ(std::ranges::count(path, 'L'), 0) << path;
  for (const char* part : {"class=\"diagonal\"", ">1.0k</text>", ">12k</text>", ">10</text>"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }

  const Chart pooled = chart_of(report, 1);
  ASSERT_EQ(pooled.panels.at(0).lines.size(), 1U);
  const Line& line = pooled.panels[0].lines[0];
  EXPECT_EQ(line.value, ".449") << "6000.5 of 13355";
  EXPECT_EQ(line.points.size(), 3U);
  EXPECT_NE(pooled.note.find("counted together that differ in method"), std::string::npos);
}

TEST(Chart, DrawsAMeasureOverASetting) {
  Report report;
  for (const auto& [ds, recall] : {std::pair{"100", 0.5}, {"20", 0.25}, {"40", 0.75}}) {
    report.results.push_back(synthetic_result("p", "A-", "d", {{"ds", ds}}, recall));
  }
  report.results.push_back(synthetic_result("p", "no ds", "d", {}, 1.0));
  report.figures = {figure(FigureKind::measure, {"method"}),
                    figure(FigureKind::measure, {"method"})};
  report.figures[1].y = "speed_up";
  const Chart chart = chart_of(report, 0);
  EXPECT_EQ(names(chart.panels.at(0)), (std::vector<std::string>{".500 A-", "– no ds"}));
  const std::vector<Point>& points = chart.panels[0].lines[0].points;
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[1].x, 40.0);
  EXPECT_EQ(points[1].y, 0.75);
  EXPECT_EQ(chart.x.ticks, (std::vector<double>{20.0, 40.0, 100.0}));
  EXPECT_EQ(chart.y.high, 1.0);
  EXPECT_EQ(chart.nothing, "");
  EXPECT_EQ(chart_of(report, 1).nothing,
            "nothing to show: no result has a number under ds and under speed_up");
}

TEST(Chart, AxesOfNumbersEndAtRoundOnes) {
  Report report;
  report.results = {synthetic_result("p", "A-", "d", {{"ds", "20"}}, 0.5)};
  report.figures = {figure(FigureKind::measure, {"method"})};
  report.figures[0].y = "distances";  // 43,264.5
  EXPECT_EQ(chart_of(report, 0).y.ticks,
            (std::vector<double>{0.0, 10000.0, 20000.0, 30000.0, 40000.0, 50000.0}));
}

/// Where the text of a class begins.
double text_begins(const std::string& svg, const std::string& of_class) {
  const std::size_t end = svg.find("class=\"" + of_class + '"');
  const std::size_t begin = svg.rfind("x=\"", end) + 3;
  return std::stod(svg.substr(begin));
}

TEST(Chart, KeepsNumbersNamesAndItsEdgeApart) {
  constexpr double bold_1_000 = 12.0 * 3.163;  // in DejaVu Sans
  Report report;
  report.results = {synthetic_result("p", std::string(200, 'n'), "d", {{"ds", "20"}}, 1.0)};
  report.figures = {figure(FigureKind::precision_recall, {"method"})};
  const std::string svg = panel_svgs(chart_of(report, 0)).at(0);
  EXPECT_GE(text_begins(svg, "name") - text_begins(svg, "value"), bold_1_000);
  const std::size_t begin = svg.find('>', svg.find("class=\"name\"")) + 1;
  const std::string name = svg.substr(begin, svg.find('<', begin) - begin);
  const auto letters = static_cast<double>(std::ranges::count(name, 'n'));
  EXPECT_LE(text_begins(svg, "name") + 12.0 * (0.634 * letters + 1.0), 392.0) << name;
}

TEST(Chart, SaysWhatItDoesNotTellApart) {
  Report report;
  report.results = {synthetic_result("p", "A-", "d", {{"k", "6"}}, 0.5),
                    synthetic_result("p", "A-", "d", {{"k", "10"}}, 0.25)};
  report.figures = {figure(FigureKind::precision_recall, {"method"})};
  EXPECT_NE(chart_of(report, 0).note.find("Lines of one name differ also in k."),
            std::string::npos);
  report.figures[0].line = {"method", "k"};
  const Chart chart = chart_of(report, 0);
  EXPECT_EQ(chart.note.find("differ"), std::string::npos);
  EXPECT_EQ(names(chart.panels.at(0)), (std::vector<std::string>{".500 k 6", ".250 k 10"}));
}

TEST(Chart, SaysWhyItIsEmpty) {
  Report report;
  report.results = {synthetic_result("p", "A-", "d", {}, 0.5)};
  report.figures = {figure(FigureKind::precision_recall, {"method"})};
  report.figures[0].where = {{"method", {"B", "C"}}, {"ds", {"20"}}};
  const Chart chart = chart_of(report, 0);
  EXPECT_EQ(chart.nothing, "nothing to show: no result has method B or C and ds 20");
  EXPECT_TRUE(panel_svgs(chart).empty());
  EXPECT_NE(figure_svg(chart, "t").find("no result has method B or C and ds 20"),
            std::string::npos);
}

TEST(LineStyles, AMethodKeepsItsColourInEveryFigure) {
  Report report;
  for (const char* method : {"A", "B", "C"}) {
    for (const char* descriptor : {"pool5", "conv3"}) {
      if (*method == 'A' && *descriptor == 'c') continue;
      report.results.push_back(synthetic_result("p", method, descriptor, {{"ds", "20"}}, 0.5));
    }
  }
  report.figures = {figure(FigureKind::precision_recall, {"method", "descriptor"}),
                    figure(FigureKind::precision_recall, {"descriptor", "method"}),
                    figure(FigureKind::precision_recall, {"method"})};
  report.figures[1].where = {{"method", {"C", "A"}}};
  report.figures[2].where = {{"descriptor", {"pool5"}}};
  const LineStyles styles(report);
  const auto colour = [&](std::size_t i, const Key& line) {
    return styles.of(report.figures[i], line).colour;
  };
  EXPECT_EQ(colour(0, {"C", "pool5"}), colour(1, {"pool5", "C"}));
  EXPECT_EQ(colour(0, {"C", "pool5"}), colour(2, {"C"}));
  EXPECT_EQ(colour(0, {"A", "pool5"}), colour(2, {"A"}));
  EXPECT_NE(colour(0, {"C", "pool5"}), colour(0, {"C", "conv3"}));
}

TEST(LineStyles, FortyLinesOfAFigureAllLookDifferent) {
  Report report;
  for (int k = 0; k < 40; ++k) {
    report.results.push_back(synthetic_result("p", "A-", "d", {{"k", std::to_string(k)}}, 0.5));
  }
  report.figures = {figure(FigureKind::precision_recall, {"k"})};
  const LineStyles styles(report);
  std::set<std::pair<std::size_t, std::size_t>> looks;
  for (int k = 0; k < 40; ++k) {
    const LineStyle style = styles.of(report.figures[0], {std::to_string(k)});
    looks.emplace(style.colour, style.dash);
  }
  EXPECT_EQ(looks.size(), 40U);
}

}  // namespace
}  // namespace seqloop::experiment
