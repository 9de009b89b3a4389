// SPDX-License-Identifier: MIT
// For seqloop-chosen-kernels, the program with the kernels that SEQLOOP_KERNELS names: this
// function stands in for the library's own.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "experiment/run/runner.hpp"
#include "program/command_line.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detail/integer_kernels.hpp"

namespace seqloop {

const IntegerKernels& best_integer_kernels() noexcept {
  const char* wanted = std::getenv("SEQLOOP_KERNELS");
  if (wanted != nullptr) {
    for (const IntegerKernels* kernels : integer_kernels()) {
      if (kernels->name != std::string_view(wanted)) continue;
      if (kernels->supported()) return *kernels;
    }
  }
  std::fprintf(stderr, "SEQLOOP_KERNELS names no kernels that run here\n");
  std::exit(2);
}

}  // namespace seqloop

int main(int argc, char** argv) {
  using namespace seqloop;
  program::run_program(argc, argv, program::all_verbs(experiment::run_experiment));
}
