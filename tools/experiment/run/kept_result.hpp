// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "experiment/report/result.hpp"

namespace seqloop::experiment {

/// Results are kept as JSON files, so that an interrupted experiment goes on where it was.
/// Throws files::IoError, SetupError.
void keep_result(const Result& result, const std::filesystem::path& file);

/// A result from what `keep_result` wrote; none when the text is no such thing.
[[nodiscard]] std::optional<Result> parse_result(std::string_view text);

/// @return none when there is no such file, or it is not one that `keep_result` wrote
[[nodiscard]] std::optional<Result> kept_result(const std::filesystem::path& file);

}  // namespace seqloop::experiment
