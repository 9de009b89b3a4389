#pragma once

#include <filesystem>
#include <optional>

#include "experiment/result.hpp"

namespace seqloop::experiment {

/// Results are kept as JSON files, so that an interrupted experiment goes on where it was.
/// Throws files::IoError, SetupError.
void keep_result(const Result& result, const std::filesystem::path& file);

/// @return none when there is no such file, or it is not one that `keep_result` wrote
[[nodiscard]] std::optional<Result> kept_result(const std::filesystem::path& file);

}  // namespace seqloop::experiment
