// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "seqloop/fault.hpp"

namespace seqloop::program {

/// Adds a fault when an output is one of the inputs, or lies in an input folder and is there
/// already.
void refuse_overwriting(Faults& faults, const std::filesystem::path& out,
                        const std::vector<std::filesystem::path>& inputs);

/// Adds a fault when a folder is not there and cannot be made.
void check_folder(Faults& faults, const std::filesystem::path& folder);

/// Throws SetupError when the folder is not there and cannot be made.
void make_folder(const std::filesystem::path& folder);

}  // namespace seqloop::program
