// SPDX-License-Identifier: MIT
#pragma once

#include "program/bench/column_bench.hpp"
#include "program/bench/matrix_bench.hpp"
#include "program/options/verb.hpp"

namespace seqloop::program {

/// What other libraries do, to be timed beside ours; may be empty.
struct Peers {
  PeerColumns columns{};
  PeerMatrices matrices{};
};

/// `bench`, with peers in the same run.
[[nodiscard]] Verb bench_verb(const Peers& peers);

}  // namespace seqloop::program
