// SPDX-License-Identifier: MIT
#include "experiment/report/result.hpp"

#include <algorithm>

#include "experiment/report/columns.hpp"
#include "experiment/report/text.hpp"

namespace seqloop::experiment {

std::string value_of(const Result& result, const std::string& name) {
  if (name == "pair") return result.pair;
  if (name == "method") return result.method;
  if (name == "descriptor") return result.descriptor;
  const auto found = std::ranges::find(result.settings, name, &Setting::name);
  return found == result.settings.end() ? std::string() : found->value;
}

double number_of(const Result& result, const std::string& name) {
  if (const Column column = column_named(name); column.read != nullptr) return column.read(result);
  return number_in(value_of(result, name));
}

}  // namespace seqloop::experiment
