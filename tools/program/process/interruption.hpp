// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop::program {

/// From now on the first SIGINT, SIGTERM or SIGHUP asks the program to stop; one that comes a
/// second later, or after that, ends it. Those before are the same request: `timeout` sends its
/// signal to the program and to its group, a terminal to all and a launcher once more to its
/// children. To be called by work that looks at `interrupted`. A signal that was ignored stays
/// ignored.
void take_interruptions() noexcept;

/// Whether the program was asked to stop.
[[nodiscard]] bool interrupted() noexcept;

/// Throws when the program was asked to stop, for work whose half is worth nothing.
void stop_if_interrupted();

}  // namespace seqloop::program
