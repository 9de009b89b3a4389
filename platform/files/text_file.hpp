// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace seqloop::files {

/// A whole text file, without the byte-order mark that some editors put in front.
/// Throws SetupError: not there, not a regular file, unreadable, above 64 MiB.
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

}  // namespace seqloop::files
