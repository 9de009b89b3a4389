// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "program/options/options.hpp"
#include "seqloop/linux/real_time.hpp"

namespace seqloop::program {

/// What a live loop asks of the system, as a user writes it.
struct RealTimeSettings {
  std::size_t priority = 0;  ///< SCHED_FIFO priority of the loop; the capture thread's is one above
  std::vector<unsigned> cpus;  ///< the only ones that both threads may run on; empty: any
  bool lock_memory = false;

  [[nodiscard]] live::ThreadSettings work_thread() const;
  [[nodiscard]] live::ThreadSettings capture_thread() const;
};

/// Flags `--realtime-…`. @param settings lives as long as the table
void add_real_time_options(OptionTable& options, RealTimeSettings& settings);

/// Locks memory, and tries on a thread of its own whether the rest will be granted, so that a
/// refusal is told before any work. Adds a fault for whatever is refused.
void prepare(const RealTimeSettings& settings, Faults& faults);

}  // namespace seqloop::program
