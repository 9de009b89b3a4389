#include "seqloop/verb.hpp"

namespace seqloop::program {

std::vector<Verb> all_verbs() {
  return {run_verb(),  describe_verb(), match_verb(),  eval_verb(),
          plan_verb(), bench_verb(),    stills_verb(), camera_verb()};
}

}  // namespace seqloop::program
