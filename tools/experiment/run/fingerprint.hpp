// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/report/result.hpp"

namespace seqloop::experiment {

/// Sixteen hexadecimal digits that differ where texts do (FNV-1a).
[[nodiscard]] std::string fingerprint(std::string_view text);

/// What tells a file, or a folder's files, from what it was before: names, sizes, times. Throws
/// SetupError when it cannot be looked at.
[[nodiscard]] std::string state_of(const std::filesystem::path& path);

/// `name=value;` of each.
[[nodiscard]] std::string text_of(const std::vector<Setting>& settings);

/// A name that is good for a file: letters, digits, dashes.
[[nodiscard]] std::string file_name(std::string_view name);

}  // namespace seqloop::experiment
