// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace seqloop::files {

/// A whole text file, without the byte-order mark that some editors put in front.
/// Throws SetupError: not there, not a regular file, unreadable, above `most_bytes`.
[[nodiscard]] std::string read_text(const std::filesystem::path& path,
                                    std::uintmax_t most_bytes = std::uintmax_t{64} << 20U);

}  // namespace seqloop::files
