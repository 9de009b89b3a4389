// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace seqloop::sqlite {

/// What came into the new file, and what did not.
struct Recovered {
  std::uint64_t sessions = 0;
  std::uint64_t places = 0;
  std::uint64_t links = 0;
  std::uint64_t thumbnails = 0;
  std::vector<std::string> lost;  ///< a line for each thing that is known to be missing
};

/// Copies every row that is whole into a new map. Rows are looked for in all pages, whatever became
/// of the trees that led to them, and checksums tell which are whole. Where places of a session
/// cannot follow each other, as few as possible are left out. Places keep their numbers; sessions
/// are numbered anew. The damaged file is only read.
/// @param in a map, with its log beside it where there is one
/// @param out a new file, or an empty one, written bit by bit: it is whole when this returns
/// @param between called again and again meanwhile; may throw to end the work
/// Throws SetupError: not readable, nothing whole in it, `out` is there already; SaveError. Work:
/// the file, three times.
[[nodiscard]] Recovered recover(
    const std::filesystem::path& in, const std::filesystem::path& out,
    const std::function<void()>& between = [] {});

}  // namespace seqloop::sqlite
