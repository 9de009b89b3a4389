// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace seqloop::program {

/// Copies all sessions of maps into a new one, which has its name only when it is complete.
/// @param between called before each map; may throw to end the work
/// @return of each map, what is added to its places' numbers
/// Throws SetupError: `out` exists, other forms, one that is named twice, damaged; SaveError.
std::vector<std::uint64_t> merge_maps(const std::vector<std::filesystem::path>& maps,
                                      const std::filesystem::path& out,
                                      const std::function<void()>& between);

}  // namespace seqloop::program
