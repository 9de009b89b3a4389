// SPDX-License-Identifier: MIT
#include "experiment/report/report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "experiment/report/chart.hpp"
#include "experiment/report/page.hpp"
#include "experiment/report/results_csv.hpp"
#include "experiment/report/text.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::experiment {
namespace {

std::string file_name(const Figure& figure, std::size_t number) {
  const std::string words = slug(figure.title);
  return fmt::format("figure-{}{}{}.svg", number, words.empty() ? "" : "-", words);
}

}  // namespace

bool is_report(const std::filesystem::path& page) {
  constexpr std::size_t head = 1'000;
  std::string start(head, '\0');
  std::ifstream(page, std::ios::binary).read(start.data(), head);
  return start.find(page_mark) != std::string::npos;
}

void write_report(const Report& report, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);  // opening a file in it says what is wrong
  std::vector<std::unique_ptr<files::OutputFile>> written;
  const auto write = [&](const std::string& name, const std::string& text) {
    written.push_back(std::make_unique<files::OutputFile>(folder / name));
    written.back()->write(text);
    written.back()->flush();
  };
  const LineStyles styles(report);
  std::vector<Chart> charts;
  std::vector<std::string> names;
  for (const Figure& figure : report.figures) {
    charts.push_back(make_chart(report.results, figure, styles));
    names.push_back(file_name(figure, names.size() + 1));
    write(names.back(), figure_svg(charts.back(), figure.title));
  }
  write("results.csv", results_csv(report.results));
  write("index.html", page_html(report, charts, names));
  for (const auto& file : written) file->commit();
}

}  // namespace seqloop::experiment
