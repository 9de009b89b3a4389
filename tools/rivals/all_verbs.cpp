#include "rivals/columns.hpp"
#include "rivals/matrices.hpp"
#include "seqloop/bench.hpp"

namespace seqloop::program {

std::vector<Verb> all_verbs() { return {bench_verb({rivals::columns, rivals::matrices})}; }

}  // namespace seqloop::program
