#pragma once

namespace seqloop::program {

/// From now on, SIGINT, SIGTERM and SIGHUP ask the program to stop, and a pipe that nobody reads is
/// a failed write and not a signal.
void take_interruptions() noexcept;

/// Whether the program was asked to stop.
[[nodiscard]] bool interrupted() noexcept;

/// Throws when the program was asked to stop, for work whose half is worth nothing.
void stop_if_interrupted();

}  // namespace seqloop::program
