// SPDX-License-Identifier: MIT
#include "experiment/report/results_csv.hpp"

#include <fmt/format.h>

#include "experiment/report/columns.hpp"
#include "experiment/report/selection.hpp"

namespace seqloop::experiment {
namespace {

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string(2, c) : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string results_csv(const std::vector<Result>& results) {
  Names names{"pair", "method", "descriptor"};
  for (std::string& name : setting_names(choose(results, {}))) names.push_back(std::move(name));
  std::string text;
  for (const std::string& name : names) text += cell(name) + ',';
  for (const Column& column : number_columns()) text += column.name + ',';
  text.back() = '\n';
  for (const Result& result : results) {
    for (const std::string& name : names) text += cell(value_of(result, name)) + ',';
    for (const Column& column : number_columns()) {
      text += fmt::format("{:.9g},", column.read(result));
    }
    text.back() = '\n';
  }
  return text;
}

}  // namespace seqloop::experiment
