// SPDX-License-Identifier: MIT
// For seqloop-chosen-kernels, the program with the kernels that SEQLOOP_KERNELS names.
#include "experiment/run/runner.hpp"
#include "program/command_line.hpp"
#include "program/verbs/all_verbs.hpp"

int main(int argc, char** argv) {
  using namespace seqloop;
  program::run_program(argc, argv, program::all_verbs(experiment::run_experiment));
}
