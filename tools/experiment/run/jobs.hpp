// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace seqloop::experiment {

/// A piece of work that needs nothing of the others.
struct Job {
  std::string name;
  double cost = 1.0;  ///< how long it takes beside the others, for the time that is left
  std::function<void()> work;
};

/// Does all jobs, `threads` at once, in the order of the list; tells on stderr which are done and
/// how much time is left. A job that fails, or an interruption, keeps further jobs from starting.
/// Throws what the first job that failed threw, or that the program was asked to stop.
void do_jobs(const std::string& doing, const std::vector<Job>& jobs, std::size_t threads);

}  // namespace seqloop::experiment
