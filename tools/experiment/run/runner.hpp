// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>

#include "seqloop/fault.hpp"

namespace seqloop::experiment {

/// Runs an experiment file and writes its report to a folder.
///
/// Everything that can be wrong is looked for before any work: drives, models, truths, lengths.
/// Then descriptors are computed, each once for all methods, and every run is matched. Both are
/// kept in the folder (`descriptors/`, `runs/`) under names that tell their settings, inputs and
/// the program's version, so that a second run goes on where the first one stopped.
///
/// @param data    where the file's relative paths start; empty: as the file says
/// @param folder  for the report, and for what is kept
/// @param threads jobs at once; runs of a timed experiment are matched one at a time
/// @param faults what is wrong already: it is told together with what is found
/// Throws SetupError (every fault), files::IoError, and when it is interrupted.
void run_experiment(const std::filesystem::path& file, const std::filesystem::path& data,
                    const std::filesystem::path& folder, std::size_t threads, Faults faults);

}  // namespace seqloop::experiment
