// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "program/options/verb.hpp"

namespace seqloop::program {

/// What a program's main function does: takes the command line apart, hands it to one verb, and
/// turns what comes back into messages and an exit code.
/// @param verbs the subcommands that are offered
/// @return 0 done, 1 failed while running, 2 refused before anything was done
[[nodiscard]] int run_program(int argc, char** argv, const std::vector<Verb>& verbs);

}  // namespace seqloop::program
