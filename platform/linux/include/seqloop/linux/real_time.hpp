// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "seqloop/fault.hpp"

namespace seqloop::live {

/// How a thread is scheduled.
struct ThreadSettings {
  int priority = 0;            ///< SCHED_FIFO, 1 .. 99; 0: as the thread is
  std::vector<unsigned> cpus;  ///< the only ones that it may run on; empty: as the thread is
};

/// @param thread what it is called in messages: `capture thread`
/// @return priorities out of range, CPUs that the machine does not have
[[nodiscard]] Faults validate(const ThreadSettings& settings, std::string_view thread);

/// Schedules the calling thread.
/// @param settings as `validate` accepts them
/// @return what was refused, and how it is granted; the rest holds, and the thread runs either way
[[nodiscard]] Faults schedule(const ThreadSettings& settings, std::string_view thread);

/// Locks all memory that the process has or will take (mlockall): no page is ever read back from
/// the disk. Threads that start later have their whole stack locked.
/// @return why it was refused, and how it is granted. Refused too under a finite limit, past which
/// every later allocation would fail
[[nodiscard]] Faults lock_memory();

/// Freed memory stays with the process (no trimming, no mmap of large blocks), so that taking it
/// again brings no page fault. Costs whatever the heap once held at most.
[[nodiscard]] Faults keep_freed_memory();

/// Touches the next 256 KiB of the calling thread's stack, so that the first deep call faults no
/// page in.
void touch_stack() noexcept;

/// What the calling thread has suffered since it began.
struct ThreadCounters {
  std::uint64_t minor_faults = 0;          ///< pages mapped without reading
  std::uint64_t major_faults = 0;          ///< pages read from the disk
  std::uint64_t voluntary_switches = 0;    ///< it waited
  std::uint64_t involuntary_switches = 0;  ///< it was set aside
};

/// Work: one system call. Allocates: never.
[[nodiscard]] ThreadCounters thread_counters() noexcept;

}  // namespace seqloop::live
