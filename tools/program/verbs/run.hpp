// SPDX-License-Identifier: MIT
#pragma once

#include "program/run/run_setup.hpp"

namespace seqloop::program {

/// Grabs, describes, matches and decides, frame by frame, until the source ends or a signal comes.
/// @param faults of the settings, found before. Throws SetupError; std::exception: what was asked
///   for could not be done to its end.
void run(const RunSettings& settings, Faults faults);

}  // namespace seqloop::program
