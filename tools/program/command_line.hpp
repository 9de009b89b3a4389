// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "program/options/verb.hpp"

namespace seqloop::program {

/// What a program's main function does: takes the command line apart, hands it to one verb, turns
/// what comes back into messages, and ends the process with an exit code: 0 done, 1 failed while
/// running, 2 refused before anything was done.
/// @param verbs the subcommands that are offered
[[noreturn]] void run_program(int argc, char** argv, const std::vector<Verb>& verbs);

}  // namespace seqloop::program
