// SPDX-License-Identifier: MIT
#include "experiment/report/report.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "expect_setup_error.hpp"
#include "experiment/synthetic_result.hpp"
#include "temporary_folder.hpp"

namespace seqloop::experiment {
namespace {

/// Whether a program of its own finds no faults in a report.
bool sound(const std::filesystem::path& folder, const std::string& output = "&2") {
  const std::string check = "'" SEQLOOP_PYTHON "' '" SEQLOOP_CHECK_REPORT "' '";
  return std::system((check + folder.string() + "' >" + output).c_str()) == 0;
}

using Files = std::map<std::string, std::string>;

/// Writes a report, checks it and gives its files back.
Files written(const Report& report) {
  const test::TemporaryFolder folder;
  write_report(report, folder.path() / "new");
  Files files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "new")) {
    files[entry.path().filename().string()] = test::read_all(entry.path());
  }
  EXPECT_TRUE(sound(folder.path() / "new"));
  return files;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Report small_report() {
  Report report;
  report.title = "Title";
  report.text = "First.\n\nSecond & last.";
  report.conditions = {{"machine", "two cores"}, {"command", "seqloop eval"}};
  report.results = {
      synthetic_result("p", "SeqSLAM", "patches", {{"ds", "20"}}, 0.305),
      synthetic_result("p", "SeqSLAM", "patches", {{"ds", "40"}}, 0.21),
      synthetic_result("p", "A-SeqCNNSLAM", "pool5", {{"ds", "20"}, {"k", "6"}}, 0.815),
      synthetic_result("q", "A-SeqCNNSLAM", "pool5", {{"ds", "20"}, {"k", "6"}}, 0.444)};
  report.results[2].speed_up = 5.23;
  report.figures = {{"Curves", "", FigureKind::precision_recall, "ds", {"method"}, "", "", {}},
                    {"Over ds", "", FigureKind::measure, "", {"method"}, "ds", "recall", {}}};
  report.tables = {{"Work", "", {"method"}, {"ds"}, {"recall_at_100_precision"}, {}}};
  report.matrices = {{"Matrix", "Text", {'M', 'a', 'n'}}};
  return report;
}

TEST(Report, HasItsFilesAndNumbers) {
  const Files files = written(small_report());
  ASSERT_EQ(files.size(), 4U);
  EXPECT_TRUE(files.contains("results.csv"));
  EXPECT_TRUE(has(files.at("figure-1-curves.svg"), ">.815</text>"));
  EXPECT_TRUE(has(files.at("figure-2-over-ds.svg"), "SeqSLAM"));
  const std::string& page = files.at("index.html");
  EXPECT_TRUE(has(page, "<p>Second &amp; last.</p>"));
  EXPECT_TRUE(has(page, "machine two cores</p>"));  // the line at the top, without the command
  EXPECT_TRUE(has(page, "<dd>seqloop eval</dd>"));
  EXPECT_TRUE(has(page, "data:image/png;base64,TWFu"));
  EXPECT_TRUE(has(page, "×5.2"));
  EXPECT_TRUE(has(page, "43,264"));
}

TEST(Report, SummaryShowsTheBestSettingsAndTheBestOfAPair) {
  const std::string page = written(small_report()).at("index.html");
  const std::string summary = page.substr(0, page.find("<h2>Figures"));
  EXPECT_TRUE(has(summary, "<td>.305</td>"));
  EXPECT_FALSE(has(summary, ".210"));            // of SeqSLAM's other ds
  EXPECT_TRUE(has(summary, "<td><b>.815</b>"));  // best of p
  EXPECT_TRUE(has(summary, "<td>.444</td>"));    // alone on q
}

TEST(Report, OfEqualResultsTheFirstIsTheBestAndThePageSaysSo) {
  Report report;
  report.results = {synthetic_result("p", "m", "d", {{"ds", "30"}}, 0.5),
                    synthetic_result("p", "m", "d", {{"ds", "10"}}, 0.5),
                    synthetic_result("p", "m", "d", {{"ds", "20"}}, 0.5)};
  report.figures = {{"Curves", "", FigureKind::precision_recall, "", {"ds"}, "", "", {}}};
  const auto summary = [&] {
    const std::string page = written(report).at("index.html");
    return page.substr(0, page.find("<h2>Figures"));
  };
  EXPECT_TRUE(has(summary(), "then those that come first in the experiment"));
  EXPECT_TRUE(has(summary(), "<th scope=\"row\">30</th>"));
  report.results[2].measures.area_under_curve = 0.6;
  EXPECT_TRUE(has(summary(), "<th scope=\"row\">20</th>"));
}

TEST(Report, SummaryTellsCurvesOverDifferentNumbersApart) {
  Report report = small_report();
  for (Result& result : report.results) result.settings.push_back({"threshold-on", "uniqueness"});
  const auto summary = [&] {
    const std::string page = written(report).at("index.html");
    return page.substr(0, page.find("<h2>Figures"));
  };
  EXPECT_FALSE(has(summary(), "threshold-on"));
  report.results[2].settings.back().value = "probability";
  EXPECT_TRUE(has(summary(), "<th scope=\"col\">threshold-on</th>"));
  EXPECT_TRUE(has(summary(), "<th scope=\"row\">probability</th>"));
}

/// Runs at once slow each other down: the least seconds are nobody's merit.
TEST(Report, SecondsAreBestAloneOnly) {
  Report report = small_report();
  report.results[2].seconds = 1.25;
  EXPECT_FALSE(has(written(report).at("index.html"), "<b>1.25</b>"));
  for (Result& result : report.results) result.alone = true;
  EXPECT_TRUE(has(written(report).at("index.html"), "<b>1.25</b>"));
}

TEST(Report, TablesPutResultsWhereTheyBelong) {
  Report report = small_report();
  report.tables = {{"Two", "", {"method"}, {"pair", "ds"}, {"recall", "seconds"}, {}}};
  std::string page = written(report).at("index.html");
  std::string table = page.substr(page.find("Table 1. Two"));
  table.resize(table.find("</table>"));
  EXPECT_TRUE(has(table, "<th scope=\"col\" class=\"n\" colspan=\"4\">p</th>"));
  EXPECT_TRUE(has(table,
                  "<th scope=\"row\">SeqSLAM</th><td>.305</td><td>12.3</td><td>.210</td>"
                  "<td>12.3</td><td></td><td></td></tr>"));
  EXPECT_TRUE(has(table, "<td><b>.815</b></td><td>12.3</td><td></td><td></td><td>.444</td>"));

  // Many columns: every measure has rows of its own.
  report.tables[0].values.resize(7, "area_under_curve");
  page = written(report).at("index.html");
  EXPECT_TRUE(has(page,
                  "<th scope=\"row\" rowspan=\"7\">SeqSLAM</th><th scope=\"row\">recall</th>"
                  "<td>.305</td><td>.210</td><td></td></tr>"));
}

TEST(Report, ShowsSeveralResultsOfOneCell) {
  Report report = small_report();
  report.tables[0].columns = {};
  const std::string page = written(report).at("index.html");
  EXPECT_TRUE(has(page, "<td>.305<br/>.210</td>"));
  EXPECT_TRUE(has(page, "Numbers in one cell differ in ds, pair.") ||
              has(page, "Numbers in one cell differ in pair, ds."));
}

TEST(Report, IsTheSameForTheSameInput) {
  EXPECT_EQ(written(small_report()), written(small_report()));
}

TEST(Report, TakesAnyText) {
  const std::string wild = "<script>alert(\"&\")</script>\x01\xFF]]> --> 'é'";
  Report report = small_report();
  report.title = report.text = report.matrices[0].title = report.matrices[0].text = wild;
  report.conditions.push_back({wild, wild});
  for (Figure& figure : report.figures) figure.title = figure.text = wild;
  report.figures[0].panel = wild;
  report.tables[0].title = report.tables[0].text = wild;
  report.tables[0].rows.push_back(wild);
  report.results.push_back(synthetic_result(wild, wild, wild, {{wild, wild}}, 0.5));
  const std::string page = written(report).at("index.html");
  EXPECT_FALSE(has(page, "<script"));
  EXPECT_TRUE(has(page, "<h1>&lt;script&gt;alert(&quot;&amp;&quot;)"));
}

TEST(Report, OfNothingSaysSo) {
  const Files files = written({});
  EXPECT_EQ(files.size(), 2U);
  EXPECT_TRUE(has(files.at("index.html"), "nothing to show: there are no results"));
}

TEST(Report, ShowsNothingWhereAFilterLetsNothingThrough) {
  Report report = small_report();
  report.figures[0].where = report.tables[0].where = {{"ds", {"17", "18"}}};
  const Files files = written(report);
  const std::string& page = files.at("index.html");
  const std::string sentence = "nothing to show: no result has ds 17 or 18";
  EXPECT_NE(page.find(sentence), page.rfind(sentence));
  EXPECT_TRUE(has(files.at("figure-1-curves.svg"), sentence));
}

TEST(Report, BearsResultsWithoutAnswersAndUndefinedNumbers) {
  Report report = small_report();
  report.results.push_back(synthetic_result("p", "silent", "none", {{"ds", "20"}}, 0.0));
  report.results[0].measures.area_under_curve = std::numeric_limits<double>::quiet_NaN();
  report.results[0].measures.recall_at_100_precision = std::numeric_limits<double>::quiet_NaN();
  report.results[1].measures.curve.resize(1);
  report.results[1].speed_up = std::numeric_limits<double>::infinity();
  report.figures[1].y = "speed_up";
  for (const auto& [name, text] : written(report)) {
    if (name == "results.csv") continue;
    EXPECT_FALSE(has(text, "nan") || has(text, "NaN")) << name;
  }
}

TEST(Report, HasRoomForManyLinesPanelsAndLongNames) {
  Report report;
  for (int panel = 0; panel < 12; ++panel) {
    for (int line = 0; line < 40; ++line) {
      const std::string method = "a method with a very long name, number " + std::to_string(line);
      report.results.push_back(synthetic_result("pair " + std::to_string(panel), method, "d",
                                                {{"ds", "20"}}, 0.9 - 0.02 * line));
    }
  }
  const std::string title(300, 'W');
  report.figures = {{title, "", FigureKind::precision_recall, "pair", {"method"}, "", "", {}},
                    {title + " x", "", FigureKind::measure, "", {"pair"}, "ds", "seconds", {}},
                    {"Said", "", FigureKind::reliability, "pair", {"method"}, "", "", {}}};
  for (const auto& [name, text] : written(report)) {
    EXPECT_TRUE(!name.starts_with("figure-1") || has(text, "er 39</text>"));
  }
}

TEST(Report, CheckFindsFaults) {
  const test::TemporaryFolder folder;
  const std::string start = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 99' ";
  const std::string name = "<text class='name' x='1' y='10'>a</text>";
  const auto refused = [&](const std::string& text) {
    folder.write("a.svg", text);
    return !sound(folder.path(), "/dev/null");
  };
  EXPECT_FALSE(refused(start + "aria-label='a'>" + name + "</svg>"));
  EXPECT_TRUE(refused(start + "aria-label='a'>" + name + name + "</svg>"));
  EXPECT_TRUE(refused(start + "aria-label='a'><text x='10' y='1'>a</text></svg>"));
  EXPECT_TRUE(refused(start + ">" + name + "</svg>"));
  EXPECT_TRUE(refused(start + "aria-label='a'>"));
  EXPECT_FALSE(sound(folder.path() / "none", "/dev/null"));
}

// Bad input: a folder that cannot be one.
TEST(Report, RefusesAFileForAFolder) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("file", "");
  const std::string error = test::setup_error([&] { write_report(small_report(), file); });
  EXPECT_TRUE(test::says(error, "is not a folder"));
}

// Bad input: one of the files cannot be written.
TEST(Report, LeavesNothingHalfWritten) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "index.html");
  EXPECT_TRUE(test::says(test::setup_error([&] { write_report(small_report(), folder.path()); }),
                         "is a folder"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace seqloop::experiment
