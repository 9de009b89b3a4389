// SPDX-License-Identifier: MIT
#include "program/process/attempts.hpp"

#include <span>
#include <stdexcept>

#include "program/process/say.hpp"

namespace seqloop::program {

void Attempts::end() const {
  if (failures_.empty() && faults_.empty()) return;
  if (failures_.empty()) throw SetupError(faults_);
  for (const Fault& fault : faults_) say("{}", to_string(fault));
  for (const std::string& why : std::span(failures_).first(failures_.size() - 1)) say("{}", why);
  throw std::runtime_error(failures_.back());
}

}  // namespace seqloop::program
