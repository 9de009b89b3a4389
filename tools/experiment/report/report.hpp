// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "experiment/report/result.hpp"

namespace seqloop::experiment {

/// Writes index.html, results.csv and figure-N-TITLE.svg for each figure into a folder, which it
/// makes where there is none. The same report gives the same bytes.
///
/// No file appears under its name before all of them are written. Throws SetupError for a folder
/// that cannot be used, files::IoError for a write that fails.
void write_report(const Report& report, const std::filesystem::path& folder);

/// Whether a file is an index.html that `write_report` wrote.
[[nodiscard]] bool is_report(const std::filesystem::path& page);

}  // namespace seqloop::experiment
