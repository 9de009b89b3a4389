// SPDX-License-Identifier: MIT
#pragma once

#include <istream>
#include <nlohmann/json.hpp>
#include <string>

namespace seqloop::program {

/// The page of a run that is over, in one file: no picture, no control, nothing from elsewhere.
/// @param lines what `run` wrote
/// @param name of those lines, for messages
/// @param run what the run was started with, as `run --summary` has it; `source` alone will do
/// Throws SetupError where a line is none of `run`'s, or there is none.
[[nodiscard]] std::string report_page(std::istream& lines, const std::string& name,
                                      nlohmann::ordered_json run);

}  // namespace seqloop::program
