// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "program/options/verb.hpp"

namespace seqloop::program {

/// Runs an experiment file, which is the business of a room of its own: file, folder that its
/// relative paths start at, folder for the report, jobs at once, and what is wrong already.
using ExperimentRunner =
    std::function<void(const std::filesystem::path& file, const std::filesystem::path& data,
                       const std::filesystem::path& out, std::size_t jobs, Faults faults)>;

[[nodiscard]] Verb describe_verb();
[[nodiscard]] Verb match_verb();
[[nodiscard]] Verb run_verb();
[[nodiscard]] Verb report_verb();
[[nodiscard]] Verb eval_verb(ExperimentRunner run_experiment);
[[nodiscard]] Verb plan_verb();
[[nodiscard]] Verb stills_verb();
[[nodiscard]] Verb camera_verb();
[[nodiscard]] Verb bag_verb();
[[nodiscard]] Verb map_verb();
[[nodiscard]] Verb keep_verb();

/// All that the program offers.
[[nodiscard]] std::vector<Verb> all_verbs(ExperimentRunner run_experiment);

}  // namespace seqloop::program
