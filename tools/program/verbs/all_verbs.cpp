// SPDX-License-Identifier: MIT
#include "program/verbs/all_verbs.hpp"

#include <utility>

#include "program/bench/bench.hpp"

namespace seqloop::program {

std::vector<Verb> all_verbs(ExperimentRunner run_experiment) {
  return {run_verb(),
          report_verb(),
          describe_verb(),
          match_verb(),
          eval_verb(std::move(run_experiment)),
          plan_verb(),
          bench_verb({}),
          stills_verb(),
          camera_verb(),
          bag_verb(),
          map_verb(),
          keep_verb()};
}

}  // namespace seqloop::program
