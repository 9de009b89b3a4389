// SPDX-License-Identifier: MIT
// `seqloop-peers bench`: the program's benchmark with peers, other libraries, beside it.
// `seqloop-peers loops`: other ways to close loops, frame by frame.
#include "peer_bench/columns.hpp"
#include "peer_bench/loops.hpp"
#include "peer_bench/matrices.hpp"
#include "program/bench/bench.hpp"
#include "program/command_line.hpp"

int main(int argc, char** argv) {
  using namespace seqloop;
  program::run_program(
      argc, argv, {program::bench_verb({peers::columns, peers::matrices}), peers::loops_verb()});
}
