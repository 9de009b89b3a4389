// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "experiment/report/result.hpp"
#include "experiment/run/experiment.hpp"

namespace seqloop::experiment {

/// Compares each run's seconds with those of the exhaustive search that is otherwise the same.
/// @param results one a run of the experiment, in its order
void add_speed_ups(const Experiment& experiment, std::vector<Result>& results);

/// Adds what `best-of` asks for: of the results that differ in one setting only, the one with the
/// highest recall at 100 % precision (of equals the largest area, then the first), as a method
/// "NAME (best)".
void add_best(const Experiment& experiment, std::vector<Result>& results);

}  // namespace seqloop::experiment
