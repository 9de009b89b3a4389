// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace seqloop::files {

constexpr std::uintmax_t usual_most_bytes = std::uintmax_t{64} << 20U;

/// Throws SetupError where a file has no bytes: of the kernel's own files (`/proc/kmsg`) some keep
/// their readers waiting for ever. Pipes, folders and what does not exist pass.
/// @param remedy what to give in its place
void refuse_empty(const std::filesystem::path& path, const std::string& remedy);

/// A whole file. Throws SetupError: not there, not a regular file, unreadable, above `most_bytes`.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& path,
                                     std::uintmax_t most_bytes = usual_most_bytes);

/// A whole text file, without the byte-order mark that some editors put in front.
/// Throws SetupError: as read_bytes, and what holds zeros, as UTF-16 and .npy files do.
[[nodiscard]] std::string read_text(const std::filesystem::path& path,
                                    std::uintmax_t most_bytes = usual_most_bytes);

}  // namespace seqloop::files
