// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "program/options/options.hpp"
#include "program/process/interruption.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {

/// One subcommand: its settings, and what it does once they are all set.
struct Verb {
  std::string name;
  std::string help;
  OptionTable options;
  /// Told what is wrong with the command line already, so that all faults come out at once.
  /// Throws SetupError (exit 2), anything else (exit 1).
  std::function<void(Faults)> run;
  std::string tasks = {};  ///< for the help, after the flags: what it is used for and with which
  /// Told what stands on the command line without a flag; nothing: it must all be flags.
  std::function<void(std::vector<std::string>)> words = {};
};

/// Runs one part of a set-up and keeps its faults, so that the other parts are looked at too. What
/// several parts find is told once. Where the program is asked to stop the set-up ends: the part
/// may have waited, as for who reads a pipe, and the next one would, too.
template <class Part>
void collect(Faults& faults, Part part) {
  try {
    part();
  } catch (const SetupError& error) {
    for (const Fault& found : error.faults()) {
      const auto same = [&](const Fault& known) { return to_string(known) == to_string(found); };
      if (std::ranges::none_of(faults, same)) faults.push_back(found);
    }
  }
  stop_if_interrupted();
}

/// Adds a fault for each flag that is given where it does nothing. @param flags with whether they
/// are
inline void refuse_given(Faults& faults, std::initializer_list<std::pair<const char*, bool>> flags,
                         const std::string& why, const std::string& remedy = "leave it out") {
  for (const auto& [flag, given] : flags) {
    if (given) faults.push_back({flag, why, remedy});
  }
}

/// Refuses a set-up that has faults.
inline void refuse(Faults faults) {
  if (!faults.empty()) throw SetupError(std::move(faults));
}

}  // namespace seqloop::program
