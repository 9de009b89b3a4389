#pragma once

#include "program/bench/column_bench.hpp"
#include "program/bench/matrix_bench.hpp"
#include "program/options/verb.hpp"

namespace seqloop::program {

/// What other libraries do, to be timed beside ours; may be empty.
struct Rivals {
  RivalColumns columns{};
  RivalMatrices matrices{};
};

/// `bench`, with rivals in the same run.
[[nodiscard]] Verb bench_verb(const Rivals& rivals);

}  // namespace seqloop::program
