#pragma once

#include "seqloop/column_bench.hpp"
#include "seqloop/verb.hpp"

namespace seqloop::program {

/// `bench`, with the columns of other libraries beside ours.
[[nodiscard]] Verb bench_verb(RivalColumns rivals);

}  // namespace seqloop::program
