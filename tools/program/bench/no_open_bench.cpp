// SPDX-License-Identifier: MIT
// Of a build without SQLite.
#include "program/bench/open_bench.hpp"
#include "program/process/say.hpp"

namespace seqloop::program {

void time_opening(const Capacity& /*size*/, std::size_t /*rounds*/, std::vector<Contender>&) {
  say("open: left out, this build was made without SQLite");
}

}  // namespace seqloop::program
