// SPDX-License-Identifier: MIT
#include "seqloop/fault.hpp"

#include <utility>

namespace seqloop {
namespace {

std::string one_line_each(const Faults& faults) {
  std::string lines;
  for (const Fault& fault : faults) {
    if (!lines.empty()) lines += '\n';
    lines += to_string(fault);
  }
  return lines;
}

}  // namespace

std::string to_string(const Fault& fault) {
  std::string line = fault.what + ": " + fault.why;
  if (!fault.remedy.empty()) line += "; " + fault.remedy;
  return line;
}

SetupError::SetupError(Faults faults)
    : std::runtime_error(one_line_each(faults)), faults_(std::move(faults)) {}

SetupError::SetupError(Fault fault) : SetupError(Faults{std::move(fault)}) {}

}  // namespace seqloop
